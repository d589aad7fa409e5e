#pragma once
#include <cassert>
#include <cstdint>
#include <span>

#include "collision/contact/body.hpp"
#include "collision/exact/ordered_sums.hpp"

namespace peerd::collision {

// One side of a separating-axis test: a convex piece, or the vertices of a whole body, whose world box is meant.
struct Solid {
  std::span<const Vec3> vertices;      // object frame
  const ConvexPiece* piece = nullptr;  // null: the world box of `vertices`
  ObjectId shape;                      // the Shape whose polygons these are
};

enum class AxisKind : std::uint8_t { kWorld, kCollideeFace, kColliderFace, kEdges, kSide };

struct Extent {
  double low, high;
};
[[nodiscard]] inline Extent extent_along(const Vec3& n_body, std::span<const Vec3> vertices) {
  assert(!vertices.empty());
  Extent e{dot(n_body, vertices[0]), 0.0};
  e.high = e.low;
  for (std::size_t i = 1; i < vertices.size(); ++i) {
    const double x = dot(n_body, vertices[i]);
    e.low = x < e.low ? x : e.low;
    e.high = x > e.high ? x : e.high;
  }
  return e;
}

// Calls visit(n_world, kind) for every direction that can separate the two, of two opposite ones only one, until it
// returns false: the collidee's face normals first, since a tie is theirs; then the collider's; the cross products of
// edges; and for two flat polygons, which may lie in one plane, the normals of their sides within their planes.
template <class Visit>
void for_each_axis(const Solid& collider, const Mat3& R_a, const Solid& collidee, const Mat3& R_b, Visit&& visit) {
  if (collider.piece == nullptr || collidee.piece == nullptr) {
    for (int k = 0; k < 3; ++k) {
      if (!visit(Vec3(Vec3::Unit(k)), AxisKind::kWorld)) return;
    }
    return;
  }
  const ConvexPiece &a = *collider.piece, &b = *collidee.piece;
  for (const Vec3& n : b.face_axes) {
    if (!visit(rotate(R_b, n), AxisKind::kCollideeFace)) return;
  }
  for (const Vec3& n : a.face_axes) {
    if (!visit(rotate(R_a, n), AxisKind::kColliderFace)) return;
  }
  for (const Vec3& edge_a : a.edge_axes) {
    const Vec3 u = rotate(R_a, edge_a);
    for (const Vec3& edge_b : b.edge_axes) {
      const Vec3 c = u.cross(rotate(R_b, edge_b));
      const double size = length(c);
      if (size == 0.0) continue;
      // The cross product of two nearly parallel edges is mostly rounding. Any direction is a valid test; taking out
      // what leans along the edge leaves an error that only matters across the facet, and that is as thin as the
      // angle between the edges.
      Vec3 n = c / size;
      n -= dot(n, u) * u;
      if (!visit(unit(n), AxisKind::kEdges)) return;
    }
  }
  if (a.faces.size() != 1 || b.faces.size() != 1) return;
  for (const Vec3& edge : b.edge_axes) {
    if (!visit(rotate(R_b, b.face_axes[0].cross(edge)), AxisKind::kSide)) return;
  }
  for (const Vec3& edge : a.edge_axes) {
    if (!visit(rotate(R_a, a.face_axes[0].cross(edge)), AxisKind::kSide)) return;
  }
}

// Calls visit(n, gap) for all these directions, both ways, until it returns false. The gap [m] is that along n from the
// collidee to the collider, and negative where they overlap; `p` leads from the collidee's origin to the collider's [m,
// world frame].
template <class Visit>
void for_each_gap(const Solid& collider, const Mat3& R_a, const Solid& collidee, const Mat3& R_b, const Vec3& p,
                  Visit&& visit) {
  for_each_axis(collider, R_a, collidee, R_b, [&](const Vec3& n, AxisKind) {
    const Extent a = extent_along(rotate_back(R_a, n), collider.vertices);
    const Extent b = extent_along(rotate_back(R_b, n), collidee.vertices);
    const double along = dot(n, p);
    return visit(n, along - (b.high - a.low)) && visit(Vec3(-n), (b.low - a.high) - along);
  });
}

// Fewer than this many roundings lie on any operand's way into a gap: the caller's evaluation of its motion (4), the
// rotation matrix and its two uses (15), normal and vertex baked into the object's frame (8), products and sums (6).
// Times u = 2^-53 and the sum of the operands' magnitudes this bounds a gap's error.
inline constexpr double kRounding = 40.0 * 0x1p-53;

static_assert(kRounding < 0x1p-47);

// Whether two unit directions differ by rounding alone.
[[nodiscard]] inline bool same_direction(const Vec3& a, const Vec3& b) {
  const Vec3 c = a.cross(b);
  return dot(a, b) > 0.0 && dot(c, c) <= kRounding * kRounding;
}

}  // namespace peerd::collision
