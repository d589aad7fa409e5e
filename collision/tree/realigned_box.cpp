#include "collision/tree/realigned_box.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "collision/tree/realignment.hpp"

namespace peerd::collision {

// Rounding to nearest keeps order, so one float more on either side holds all; kdop_tree.cpp has the same.
Kdop<18> dop_of(const Mesh& mesh, const Mat3& stretch) {
  auto dop = Kdop<18>::empty();
  std::vector<bool> used(mesh.vertices.size());
  for (const std::int32_t corner : mesh.corners) {
    if (corner != Mesh::kEndOfPolygon) used[static_cast<std::size_t>(corner)] = true;
  }
  const bool stretched = stretch != Mat3::Identity();
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    const Vec3 parsed = mesh.vertices[v].cast<double>();
    const Vec3 p = stretched ? multiply(stretch, parsed) : parsed;
    for (std::size_t s = 0; s < dop.kSlabs; ++s) {
      const auto at = static_cast<float>(along(dop.kDirections[s], p));
      dop.lo[s] = std::min(dop.lo[s], at);
      dop.hi[s] = std::max(dop.hi[s], at);
    }
  }
  constexpr float kUnbounded = std::numeric_limits<float>::infinity();
  for (std::size_t s = 0; s < dop.kSlabs; ++s) {
    dop.lo[s] = std::nextafter(dop.lo[s], -kUnbounded);
    dop.hi[s] = std::nextafter(dop.hi[s], kUnbounded);
  }
  return dop;
}

WorldBox realigned_box(const Kdop<18>& dop, const Pose& world_from_shape) {
  WorldBox box;
  if (!(dop.lo[0] <= dop.hi[0])) return box;
  double extent = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    extent = std::max({extent, std::abs(static_cast<double>(dop.lo[k])), std::abs(static_cast<double>(dop.hi[k]))});
  }
  assert(extent >= 0.0);
  static_assert(Kdop<18>::kDirections[0][0] == 1 && Kdop<18>::kDirections[1][1] == 1 &&
                Kdop<18>::kDirections[2][2] == 1);
  // The first three slabs are the axes.
  const WideKdop<18> there = Realignment<18>(RelativeMotion(Pose{}, world_from_shape), extent)(dop);
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = there.lo[static_cast<std::size_t>(k)];
    box.hi[k] = there.hi[static_cast<std::size_t>(k)];
  }
  return box;
}

}  // namespace peerd::collision
