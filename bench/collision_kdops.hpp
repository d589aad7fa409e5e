#pragma once
#include <algorithm>
#include <span>
#include <vector>

#include "collision/tree/kdop_volume.hpp"

namespace peerd::bench {

// Corners of polygons that bound a polyhedron, each once, up to rounding.
inline std::vector<Vec3> corners_of(const std::vector<std::vector<Vec3>>& polygons) {
  std::vector<Vec3> out;
  for (const auto& polygon : polygons) {
    for (const Vec3& p : polygon) {
      const auto same = [&](const Vec3& q) { return (p - q).squaredNorm() < 1e-24; };
      if (std::ranges::none_of(out, same)) out.push_back(p);
    }
  }
  return out;
}

// The polygons bound a closed polyhedron without holes; they may be wound either way if it is convex.
inline double volume_of(const std::vector<std::vector<Vec3>>& polygons) {
  Vec3 inside = Vec3::Zero();
  double corners = 0;
  for (const auto& polygon : polygons) {
    for (const Vec3& p : polygon) inside += p, ++corners;
  }
  if (corners > 0) inside /= corners;
  double six_volumes = 0;
  for (const auto& polygon : polygons) {
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
      six_volumes += std::abs((polygon[0] - inside).dot((polygon[i] - inside).cross(polygon[i + 1] - inside)));
    }
  }
  return six_volumes / 6;
}

}  // namespace peerd::bench
