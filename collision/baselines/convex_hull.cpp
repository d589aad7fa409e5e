#include "collision/baselines/convex_hull.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <map>
#include <numeric>

#include "collision/exact/orientation.hpp"

namespace peerd::collision::baselines {
namespace {

constexpr std::size_t next_side(std::size_t side) { return (side + 1) % 3; }

class QuickHull {
 public:
  explicit QuickHull(std::span<const Vec3> points) : points_(points) {}

  // False where no four points have a volume.
  bool run() {
    if (!begin()) return false;
    for (std::uint32_t i = 0; i < facets_.size(); ++i) {
      // add() makes new facets behind this one, which is gone then.
      if (facets_[i].is_alive && !facets_[i].outside.empty()) add(i);
    }
    return true;
  }

  [[nodiscard]] std::vector<std::uint32_t> corners() const {
    std::vector<std::uint32_t> out;
    for (const Facet& facet : facets_) {
      if (facet.is_alive) out.insert(out.end(), facet.corners.begin(), facet.corners.end());
    }
    std::ranges::sort(out);
    const auto rest = std::ranges::unique(out);
    out.erase(rest.begin(), rest.end());
    return out;
  }

 private:
  struct Facet {
    std::array<std::uint32_t, 3> corners;      // counter-clockwise seen from outside
    std::array<std::uint32_t, 3> neighbors{};  // neighbors[i] is beyond the side from corner i to the next one
    std::vector<std::uint32_t> outside{};      // points above this facet that no other facet has
    bool is_alive = true;
  };

  [[nodiscard]] int side_of(const Facet& facet, std::uint32_t point) {
    const auto& [a, b, c] = facet.corners;
    return volume_sign(points_[a], points_[b], points_[c], points_[point], counters_);
  }
  // Six times the volume between the facet and the point, rounded: it only orders points.
  [[nodiscard]] double height(const std::array<std::uint32_t, 3>& facet, std::uint32_t point) const {
    const Vec3& a = points_[facet[0]];
    return (points_[facet[1]] - a).cross(points_[facet[2]] - a).dot(points_[point] - a);
  }
  template <class Value>
  [[nodiscard]] std::uint32_t largest(Value value) const {
    std::uint32_t best = 0;
    for (std::uint32_t i = 1; i < points_.size(); ++i) {
      if (value(i) > value(best)) best = i;
    }
    return best;
  }

  // Makes the first tetrahedron.
  bool begin() {
    if (points_.size() < 4) return false;
    const Vec3& first = points_[0];
    const std::uint32_t b = largest([&](std::uint32_t i) { return (points_[i] - first).squaredNorm(); });
    const Vec3 along = points_[b] - first;
    const std::uint32_t c = largest([&](std::uint32_t i) { return along.cross(points_[i] - first).squaredNorm(); });
    const Facet base{{0, b, c}};
    const std::uint32_t d = largest([&](std::uint32_t i) { return std::abs(height(base.corners, i)); });
    const int side = side_of(base, d);
    if (side == 0) return false;
    // Seen from d the base runs counter-clockwise where d is above it.
    const std::array<std::uint32_t, 3> ring = side < 0 ? std::array{0u, b, c} : std::array{0u, c, b};
    facets_ = {{ring, {1, 2, 3}}};
    for (std::uint32_t i = 0; i < 3; ++i) {
      const std::uint32_t before = 1 + (i + 2) % 3, after = 1 + (i + 1) % 3;
      facets_.push_back({{ring[next_side(i)], ring[i], d}, {0, before, after}});
    }
    std::vector<std::uint32_t> all(points_.size());
    std::iota(all.begin(), all.end(), 0u);
    distribute(all, 0);
    return true;
  }

  // Gives each point to the first facet from `first` on that it is above; the others are inside.
  void distribute(std::span<const std::uint32_t> points, std::size_t first) {
    for (const std::uint32_t point : points) {
      for (std::size_t i = first; i < facets_.size(); ++i) {
        if (side_of(facets_[i], point) <= 0) continue;
        facets_[i].outside.push_back(point);
        break;
      }
    }
  }

  // Puts the farthest point of a facet on the hull. What it sees becomes a cone over the border of that, the horizon.
  // The paper's lemma holds exactly: what is outside of the new hull, and saw a facet that is gone, is above a facet of
  // the cone.
  void add(std::uint32_t seen_facet) {
    const Facet& from = facets_[seen_facet];
    const std::uint32_t point =
        *std::ranges::max_element(from.outside, {}, [&](std::uint32_t i) { return height(from.corners, i); });
    std::vector<std::uint32_t> visible{seen_facet}, left_over;
    facets_[seen_facet].is_alive = false;
    const auto first = static_cast<std::uint32_t>(facets_.size());
    std::map<std::uint32_t, std::uint32_t> facet_from,
        facet_to;  // by the horizon's corner where the facet begins, ends
    for (std::size_t at = 0; at < visible.size(); ++at) {
      for (std::size_t side = 0; side < 3; ++side) {
        const Facet& facet = facets_[visible[at]];
        const std::uint32_t other = facet.neighbors[side];
        if (!facets_[other].is_alive) continue;  // it is seen, too
        if (side_of(facets_[other], point) > 0) {
          facets_[other].is_alive = false;
          visible.push_back(other);
          continue;
        }
        cone_.push_back({{facet.corners[side], facet.corners[next_side(side)], point}, {other, 0, 0}});
      }
    }
    for (std::uint32_t i = 0; i < cone_.size(); ++i) {
      const bool is_ring = facet_from.emplace(cone_[i].corners[0], first + i).second &&
                           facet_to.emplace(cone_[i].corners[1], first + i).second;
      assert(is_ring);
      (void)is_ring;
    }
    for (std::uint32_t i = 0; i < cone_.size(); ++i) {
      Facet& facet = cone_[i];
      facet.neighbors[1] = facet_from.at(facet.corners[1]);
      facet.neighbors[2] = facet_to.at(facet.corners[0]);
      Facet& below = facets_[facet.neighbors[0]];
      for (std::size_t side = 0; side < 3; ++side) {
        if (below.corners[side] == facet.corners[1] && below.corners[next_side(side)] == facet.corners[0]) {
          below.neighbors[side] = first + i;
        }
      }
    }
    for (const std::uint32_t i : visible) {
      left_over.insert(left_over.end(), facets_[i].outside.begin(), facets_[i].outside.end());
      facets_[i].outside = {};
    }
    facets_.insert(facets_.end(), cone_.begin(), cone_.end());
    cone_.clear();
    std::erase(left_over, point);
    distribute(left_over, first);
  }

  std::span<const Vec3> points_;
  std::vector<Facet> facets_;  // those that are gone included
  std::vector<Facet> cone_;
  OrientationCounters counters_;
};

}  // namespace

std::vector<std::uint32_t> hull_corners(std::span<const Vec3> points) {
  QuickHull hull(points);
  if (hull.run()) return hull.corners();
  std::vector<std::uint32_t> all(points.size());
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

std::vector<Vec3> hull_of(const TriangleSoup& soup) {
  std::vector<bool> used(soup.vertices.size());
  for (const TriangleSoup::Face& face : soup.faces) {
    for (const std::uint32_t corner : face.corners) used[corner] = true;
  }
  std::vector<Vec3> points, out;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i]) points.push_back(soup.vertices[i]);
  }
  for (const std::uint32_t i : hull_corners(points)) out.push_back(points[i]);
  return out;
}

}  // namespace peerd::collision::baselines
