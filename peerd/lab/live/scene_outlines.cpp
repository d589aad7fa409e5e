#include "peerd/lab/live/scene_outlines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "core/geometry/tessellate.hpp"
#include "core/motion/predefined_motion.hpp"

namespace peerd {
namespace {

using Vec2 = Eigen::Vector2d;

// The hull of a mesh with more corners is that of its box: a report takes no longer for a terrain than for a house.
constexpr std::size_t kMeshCornersMax = 20'000;
constexpr double kFarthest_m = 1e30;         // nobody looks farther, and squares of it are numbers
constexpr std::size_t kHullCornersMax = 48;  // enough for a circle of 500 px to look round

// The extent of one geometry in its own frame.
struct Extent {
  LocalBox box;
  bool large = false;  // more than kMeshCornersMax
};

// The outline of one Shape, and how much it matters for a picture.
struct Candidate {
  std::uint32_t shape;
  std::optional<ObjectId> owned;  // the owned object that moves it
  double distance_m = 0.0;        // from the places of the run's objects
  double area_m2 = 0.0;
};

// The corners of the convex hull in order around it, after Andrew (1979). `points` has at least one.
std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
  std::ranges::sort(points, {}, [](const Vec2& p) { return std::pair(p.x(), p.y()); });
  const auto repeated = std::ranges::unique(points);
  points.erase(repeated.begin(), repeated.end());
  if (points.size() < 3) return points;
  std::vector<Vec2> hull;
  const auto add = [&](const Vec2& p, std::size_t least) {
    const auto turns_left = [&] {
      const Vec2 a = hull.back() - hull[hull.size() - 2], b = p - hull.back();
      return a.x() * b.y() - a.y() * b.x() > 0.0;
    };
    while (hull.size() >= least && !turns_left()) hull.pop_back();
    hull.push_back(p);
  };
  for (const Vec2& p : points) add(p, 2);
  const std::size_t lower = hull.size() + 1;
  for (auto p = points.rbegin() + 1; p != points.rend(); ++p) add(*p, lower);
  hull.pop_back();  // the first point again
  return hull;
}

std::vector<Vec2> thinned(std::vector<Vec2> hull) {
  if (hull.size() <= kHullCornersMax) return hull;
  std::vector<Vec2> kept;
  for (std::size_t i = 0; i < kHullCornersMax; ++i) kept.push_back(hull[i * hull.size() / kHullCornersMax]);
  return kept;
}

std::array<Vec3, 8> corners_of(const LocalBox& box) {
  std::array<Vec3, 8> corners;
  for (int i = 0; i < 8; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      corners[static_cast<std::size_t>(i)][axis] = (i >> axis & 1) != 0 ? box.hi[axis] : box.lo[axis];
    }
  }
  return corners;
}

// The outlines of one run's scene.
class OutlineFinder {
 public:
  OutlineFinder(const Scene& scene, const measure::RunRecord& run)
      : scene_(scene), run_(run), motion_(scene), extents_(scene.geometries.size()) {
    for (const measure::GhostSample& s : run.ghost_samples) {
      if (s.truth.position.allFinite()) places_.merge(s.truth.position);
      const auto [at, is_new] = first_places_.try_emplace(s.object, s.t_s, s.truth);
      if (!is_new && s.t_s < at->second.first) at->second = {s.t_s, s.truth};
    }
  }

  SceneOutlines find() {
    std::vector<Candidate> candidates = this->candidates();
    std::ranges::sort(candidates, {}, [](const Candidate& c) { return std::tuple(c.distance_m, -c.area_m2, c.shape); });
    SceneOutlines found;
    if (candidates.size() > kOutlinesMax) {
      found.left_out = candidates.size() - kOutlinesMax;
      candidates.resize(kOutlinesMax);
    }
    for (const Candidate& c : candidates) found.outlines.push_back(outline(c));
    return found;
  }

 private:
  std::vector<Candidate> candidates() {
    std::vector<Candidate> candidates;
    std::vector<std::optional<ObjectId>> owned_above(scene_.instances.size());
    for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
      const Instance& instance = scene_.instances[i];
      const ObjectId id = scene_.id_of(i);
      if (instance.parent >= 0) owned_above[i] = owned_above[static_cast<std::size_t>(instance.parent)];
      if (std::ranges::binary_search(run_.objects, id, {}, &measure::ObjectInfo::object)) {
        owned_above[i] = id;
      }
      const Geometry* const geometry = scene_.geometry(id);
      if (geometry == nullptr || !(instance.collides || instance.drawn)) continue;
      if (!owned_above[i] && motion_.moves(id)) continue;
      Candidate candidate{.shape = i, .owned = owned_above[i]};
      if (judge(candidate)) candidates.push_back(candidate);
    }
    return candidates;
  }

  // Says how near and how large the Shape is; false where it has no surface or no finite place.
  bool judge(Candidate& candidate) {
    const LocalBox& box = measured(scene_.instances[candidate.shape].geometry).box;
    if (box.is_empty()) return false;
    const Eigen::Affine3d world_from_shape = this->world_from_shape(candidate);
    WorldBox world;
    for (const Vec3& corner : corners_of(box)) {
      const Vec3 p = world_from_shape * corner;
      if (!p.allFinite() || p.cwiseAbs().maxCoeff() > kFarthest_m) return false;
      world.merge(p);
    }
    const Vec3 size = world.hi - world.lo;
    candidate.area_m2 = size.x() * size.z();
    if (places_.is_empty()) return true;
    const Vec3 gap = (world.lo - places_.hi).cwiseMax(places_.lo - world.hi).cwiseMax(0.0);
    candidate.distance_m = std::hypot(gap.x(), gap.z());
    return true;
  }

  const Extent& measured(std::uint32_t geometry) {
    std::optional<Extent>& extent = extents_[geometry];
    if (!extent) {
      const Mesh mesh = build_mesh(scene_.geometries[geometry], scene_.tessellation);
      extent = {box_of(mesh), mesh.corners.span().size() > kMeshCornersMax};
    }
    return *extent;
  }

  [[nodiscard]] Eigen::Affine3d world_from_shape(const Candidate& c) const {
    const ObjectId shape{c.shape};
    const auto place = c.owned ? first_places_.find(*c.owned) : first_places_.end();
    if (place == first_places_.end()) return scene_.world_from_local(shape);
    const Pose& truth = place->second.second;
    return Eigen::Translation3d(truth.position) * truth.orientation * scene_.object_from_shape(*c.owned, shape);
  }

  measure::SceneOutline outline(const Candidate& c) {
    const Eigen::Affine3d world_from_shape = this->world_from_shape(c);
    const std::uint32_t geometry = scene_.instances[c.shape].geometry;
    measure::SceneOutline outline{.owned = c.owned, .corners = {}};
    std::vector<Vec2> points;
    const auto add = [&](const Vec3& p_shape) {
      const Vec3 p = world_from_shape * p_shape;
      points.emplace_back(p.x(), p.z());
      outline.bottom_m = points.size() == 1 ? p.y() : std::min(outline.bottom_m, p.y());
      outline.top_m = points.size() == 1 ? p.y() : std::max(outline.top_m, p.y());
    };
    if (const Extent& extent = measured(geometry); extent.large) {
      for (const Vec3& corner : corners_of(extent.box)) add(corner);
    } else {
      const Mesh mesh = build_mesh(scene_.geometries[geometry], scene_.tessellation);
      for (const std::int32_t corner : mesh.corners.span()) {
        if (corner != Mesh::kEndOfPolygon) add(mesh.vertices[static_cast<std::size_t>(corner)].cast<double>());
      }
    }
    outline.corners = thinned(convex_hull(std::move(points)));
    return outline;
  }

  const Scene& scene_;
  const measure::RunRecord& run_;
  PredefinedMotion motion_;
  std::vector<std::optional<Extent>> extents_;                // by geometry
  std::map<ObjectId, std::pair<double, Pose>> first_places_;  // time and truth
  WorldBox places_;                                           // of all truth
};

}  // namespace

SceneOutlines outlines_of(const Scene& scene, const measure::RunRecord& run) {
  return OutlineFinder(scene, run).find();
}

}  // namespace peerd
