#include "collision/volumes/convex_hull.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "collision/exact/orientation.hpp"

namespace peerd::collision {
namespace {

using Index = std::uint32_t;
constexpr Index kNoIndex = ~Index{0};

struct HullFacet {
  std::array<Index, 3> corners;    // counter-clockwise seen from outside
  std::array<Index, 3> neighbors;  // the facet across the edge from corner i to corner i + 1
  std::vector<Index> outside;      // points in front of this facet, each kept by one facet only
  bool alive = true;
  std::uint32_t visited = 0;  // the number of the last addition that looked at it
  bool visible = false;       // from that addition's point
};

class Quickhull {
 public:
  explicit Quickhull(std::span<const Vec3> points) : points_(points), starts_at_(points.size(), kNoIndex) {}

  // False where all points lie in one plane.
  bool run() {
    const auto simplex = first_simplex();
    if (!simplex) return false;
    begin(*simplex);
    while (!pending_.empty()) {
      const Index facet = pending_.back();
      if (!facets_[facet].alive || facets_[facet].outside.empty()) {
        pending_.pop_back();
        continue;
      }
      add(facet);
    }
    return true;
  }

  [[nodiscard]] ConvexHull hull() const {
    ConvexHull out;
    std::vector<Index> corner_of(points_.size(), kNoIndex);
    for (const HullFacet& facet : facets_) {
      if (!facet.alive) continue;
      auto& triangle = out.triangles.emplace_back();
      for (std::size_t i = 0; i < 3; ++i) {
        Index& corner = corner_of[facet.corners[i]];
        if (corner == kNoIndex) {
          corner = static_cast<Index>(out.corners.size());
          out.corners.push_back(points_[facet.corners[i]]);
        }
        triangle[i] = corner;
      }
    }
    const Vec3& origin = out.corners.front();
    for (const auto& [a, b, c] : out.triangles) {
      out.volume_m3 += (out.corners[a] - origin).dot((out.corners[b] - origin).cross(out.corners[c] - origin)) / 6.0;
    }
    return out;
  }

 private:
  [[nodiscard]] int side(const std::array<Index, 3>& t, Index p) {
    return volume_sign(points_[t[0]], points_[t[1]], points_[t[2]], points_[p], counters_);
  }
  [[nodiscard]] bool on_one_line(Index a, Index b, Index p) {
    for (int i = 0; i < 3; ++i) {
      if (orient2d(points_[a], points_[b], points_[p], i, (i + 1) % 3, counters_) != 0) return false;
    }
    return true;
  }

  // The point with the greatest value of those that are accepted. Values are rounded and only choose; accept() is
  // exact.
  template <class Value, class Accept>
  [[nodiscard]] std::optional<Index> best(Value value, Accept accept) {
    std::optional<Index> found;
    double most = 0.0;
    for (Index p = 0; p < points_.size(); ++p) {
      const double of_p = value(points_[p]);
      if (found && !(of_p > most)) continue;
      if (!accept(p)) continue;
      found = p;
      most = of_p;
    }
    return found;
  }

  // Four points that are not in one plane, far from each other.
  std::optional<std::array<Index, 4>> first_simplex() {
    if (points_.empty()) return std::nullopt;
    const Vec3& origin = points_[0];
    const auto b =
        best([&](const Vec3& p) { return (p - origin).squaredNorm(); }, [&](Index p) { return points_[p] != origin; });
    if (!b) return std::nullopt;
    const Vec3 line = points_[*b] - origin;
    const auto c = best([&](const Vec3& p) { return line.cross(p - origin).squaredNorm(); },
                        [&](Index p) { return !on_one_line(0, *b, p); });
    if (!c) return std::nullopt;
    const Vec3 normal = line.cross(points_[*c] - origin);
    const auto d = best([&](const Vec3& p) { return std::abs(normal.dot(p - origin)); },
                        [&](Index p) {
                          return side({0, *b, *c}, p) != 0;
                        });
    if (!d) return std::nullopt;
    std::array<Index, 4> out{0, *b, *c, *d};
    if (side({out[0], out[1], out[2]}, out[3]) > 0) std::swap(out[1], out[2]);
    return out;
  }

  void begin(const std::array<Index, 4>& s) {
    const auto& [a, b, c, d] = s;  // d is behind a b c
    facets_ = {
        {{a, b, c}, {1, 2, 3}, {}}, {{b, a, d}, {0, 3, 2}, {}}, {{c, b, d}, {0, 1, 3}, {}}, {{a, c, d}, {0, 2, 1}, {}}};
    std::vector<Index> all(points_.size());
    for (Index p = 0; p < all.size(); ++p) all[p] = p;
    share_out(all, 0);
  }

  // Gives each point that is in front of a facet from `first_facet` on to one of those.
  void share_out(const std::vector<Index>& points, Index first_facet) {
    for (const Index p : points) {
      for (Index f = first_facet; f < facets_.size(); ++f) {
        if (side(facets_[f].corners, p) <= 0) continue;
        facets_[f].outside.push_back(p);
        break;
      }
    }
    for (Index f = first_facet; f < facets_.size(); ++f) {
      if (!facets_[f].outside.empty()) pending_.push_back(f);
    }
  }

  [[nodiscard]] Index farthest(const HullFacet& facet) const {
    const Vec3& a = points_[facet.corners[0]];
    const Vec3 normal = (points_[facet.corners[1]] - a).cross(points_[facet.corners[2]] - a);
    return *std::ranges::max_element(facet.outside, {}, [&](Index p) { return normal.dot(points_[p] - a); });
  }

  // Replaces all facets that see the farthest point of a facet by a cone from that point.
  void add(Index facet) {
    const Index p = farthest(facets_[facet]);
    assert(side(facets_[facet].corners, p) > 0);
    ++additions_;
    std::vector<Index> orphans;
    horizon_.clear();
    find_visible(facet, p, orphans);
    assert(horizon_.size() >= 3);
    const auto first_new = static_cast<Index>(facets_.size());
    for (const Edge& edge : horizon_) {
      starts_at_[edge.from] = static_cast<Index>(facets_.size());
      facets_.push_back({{edge.from, edge.to, p}, {edge.beyond, kNoIndex, kNoIndex}, {}});
      HullFacet& beyond = facets_[edge.beyond];
      for (std::size_t i = 0; i < 3; ++i) {
        if (beyond.corners[i] == edge.to) beyond.neighbors[i] = starts_at_[edge.from];
      }
    }
    for (Index f = first_new; f < facets_.size(); ++f) {
      const Index next = starts_at_[facets_[f].corners[1]];
      assert(next >= first_new && next < facets_.size());
      facets_[f].neighbors[1] = next;
      facets_[next].neighbors[2] = f;
    }
    share_out(orphans, first_new);
  }

  void find_visible(Index facet, Index p, std::vector<Index>& orphans) {
    std::vector<Index> stack{facet};
    facets_[facet].visited = additions_;
    facets_[facet].visible = true;
    while (!stack.empty()) {
      HullFacet& seen = facets_[stack.back()];
      stack.pop_back();
      seen.alive = false;
      for (const Index q : seen.outside) {
        if (q != p) orphans.push_back(q);
      }
      seen.outside = {};
      for (std::size_t i = 0; i < 3; ++i) {
        HullFacet& neighbor = facets_[seen.neighbors[i]];
        if (neighbor.visited != additions_) {
          neighbor.visited = additions_;
          neighbor.visible = side(neighbor.corners, p) > 0;
          if (neighbor.visible) stack.push_back(seen.neighbors[i]);
        }
        if (!neighbor.visible) horizon_.push_back({seen.corners[i], seen.corners[(i + 1) % 3], seen.neighbors[i]});
      }
    }
  }

  struct Edge {
    Index from, to, beyond;  // counter-clockwise around what is visible; `beyond` is the facet that stays
  };

  std::span<const Vec3> points_;
  std::vector<HullFacet> facets_;
  std::vector<Index> pending_;    // facets that may have points outside
  std::vector<Index> starts_at_;  // by point: the new facet whose edge of the horizon begins there
  std::vector<Edge> horizon_;
  std::uint32_t additions_ = 0;
  OrientationCounters counters_;
};

}  // namespace

std::optional<ConvexHull> convex_hull(std::span<const Vec3> points) {
  Quickhull quickhull(points);
  if (!quickhull.run()) return std::nullopt;
  return quickhull.hull();
}

}  // namespace peerd::collision
