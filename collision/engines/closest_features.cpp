#include "collision/engines/closest_features.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

namespace peerd::collision::engines {
namespace {

using Corner = ClosestFeatures::Corner;

// Searches that take longer than any of the tests' end as if the pieces touched: the triangles decide then.
constexpr int kMostRounds = 64;
// The nearest points are found where the distance is known to this part of its square.
constexpr double kRelativeAccuracy = 0x1p-30;

// The point of the affine hull of up to four points that is nearest to the origin, where it is between them.
std::optional<Vec3> nearest_inside(std::span<const Vec3> points) {
  const Vec3& p = points[0];
  if (points.size() == 1) return p;
  if (points.size() == 2) {
    const Vec3 u = points[1] - p;
    const double t = -p.dot(u) / u.squaredNorm();
    if (!(t >= 0.0 && t <= 1.0)) return std::nullopt;
    return p + t * u;
  }
  const Vec3 u = points[1] - p, v = points[2] - p;
  if (points.size() == 3) {
    const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), pu = -p.dot(u), pv = -p.dot(v);
    const double volume = uu * vv - uv * uv;
    const double s = (pu * vv - pv * uv) / volume, t = (pv * uu - pu * uv) / volume;
    if (!(s >= 0.0 && t >= 0.0 && s + t <= 1.0)) return std::nullopt;
    return p + s * u + t * v;
  }
  const Vec3 w = points[3] - p;
  const double volume = u.dot(v.cross(w));
  const double r = -p.dot(v.cross(w)) / volume, s = -u.dot(p.cross(w)) / volume, t = -u.dot(v.cross(p)) / volume;
  if (!(r >= 0.0 && s >= 0.0 && t >= 0.0 && r + s + t <= 1.0)) return std::nullopt;
  return Vec3::Zero();
}

// The simplex of the differences of corners, A's less B's.
struct Simplex {
  std::array<Vec3, 4> points;
  std::array<Corner, 4> corners{};
  std::size_t count = 0;

  Simplex() { points.fill(Vec3::Zero()); }

  void add(const Vec3& point, const Corner& corner) {
    assert(count < 4);
    points[count] = point;
    corners[count] = corner;
    ++count;
  }
  [[nodiscard]] bool has(const Corner& corner) const {
    return std::find(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(count), corner) !=
           corners.begin() + static_cast<std::ptrdiff_t>(count);
  }
  // Leaves those corners between which the point that is nearest to the origin is, the fewest, and returns it.
  Vec3 reduce() {
    std::array<unsigned, 15> subsets{};
    for (unsigned i = 0; i < subsets.size(); ++i) subsets[i] = i + 1;
    std::ranges::stable_sort(subsets, {}, [](unsigned subset) { return std::popcount(subset); });
    Simplex best;
    Vec3 nearest = Vec3::Zero();
    double least = 0.0;
    for (const unsigned subset : subsets) {
      if (subset >> count != 0) continue;
      Simplex part;
      for (std::size_t i = 0; i < count; ++i) {
        if ((subset >> i & 1) != 0) part.add(points[i], corners[i]);
      }
      const auto inside = nearest_inside({part.points.data(), part.count});
      if (!inside || !(best.count == 0 || inside->squaredNorm() < least)) continue;
      best = part;
      nearest = *inside;
      least = inside->squaredNorm();
    }
    assert(best.count > 0);
    *this = best;
    return nearest;
  }
};

}  // namespace

// Climbs from corner to corner, then visits all that is reached without a certain descent: the farthest vertex is among
// those, because on a convex polyhedron some path of edges ascends to it from anywhere.
std::uint32_t FeatureWalk::support(const Placed& placed, const Vec3& direction, std::uint32_t from, double room) {
  const auto height = [&](std::uint32_t place) { return direction.dot(placed.at(place)); };
  std::uint32_t best = from;
  double of_best = height(from);
  for (bool climbs = true; climbs;) {
    climbs = false;
    const std::uint32_t here = best;
    for (const std::uint32_t next : placed.piece.neighbors[here]) {
      ++steps_;
      if (const double value = height(next); value > of_best) {
        best = next;
        of_best = value;
        climbs = true;
      }
    }
  }
  open_.assign(1, best);
  visited_.assign(1, best);
  while (!open_.empty()) {
    const std::uint32_t here = open_.back();
    const double of_here = height(here);
    open_.pop_back();
    for (const std::uint32_t next : placed.piece.neighbors[here]) {
      const double value = height(next);
      if (value < of_here - room || std::ranges::find(visited_, next) != visited_.end()) continue;
      ++steps_;
      open_.push_back(next);
      visited_.push_back(next);
      if (value > of_best) {
        best = next;
        of_best = value;
      }
    }
  }
  return best;
}

bool FeatureWalk::apart(const Placed& a, const Placed& b, double room_m, ClosestFeatures& features) {
  assert(features.count >= 1 && features.count <= 4 && room_m > 0.0);
  Simplex simplex;
  const auto difference = [&](const Corner& corner) { return Vec3(a.at(corner.a) - b.at(corner.b)); };
  for (std::size_t i = 0; i < features.count; ++i) simplex.add(difference(features.corners[i]), features.corners[i]);
  bool are_apart = false;
  double last = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kMostRounds; ++round) {
    const Vec3 nearest = simplex.reduce();
    const double square = nearest.squaredNorm();
    if (!(square > room_m * room_m) || !(square < last)) break;
    last = square;
    const double room = room_m * std::sqrt(square);
    const Corner next{support(a, -nearest, simplex.corners[0].a, room),
                      support(b, nearest, simplex.corners[0].b, room)};
    const Vec3 point = difference(next);
    // The gap between the two along `nearest`, times the length of that.
    const double gap = nearest.dot(point);
    are_apart = are_apart || gap > 4.0 * room;
    if (square - gap <= kRelativeAccuracy * square || simplex.has(next) || simplex.count == 4) break;
    simplex.add(point, next);
  }
  features.corners = simplex.corners;
  features.count = simplex.count;
  return are_apart;
}

}  // namespace peerd::collision::engines
