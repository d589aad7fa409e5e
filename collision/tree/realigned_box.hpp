#pragma once
#include "collision/tree/kdop.hpp"
#include "core/box.hpp"
#include "core/geometry/mesh.hpp"

namespace peerd::collision {

// The seed's box of a moved object (3.2.3), for collision type BOX: of an 18-DOP that is made once, in the Shape's
// frame, and realigned to the world's axes wherever the Shape stands. No vertex is read then; it is larger than the
// vertices' own box.

// Of the vertices that polygons use, each multiply(stretch, vertex).
[[nodiscard]] Kdop<18> dop_of(const Mesh& mesh, const Mat3& stretch);
[[nodiscard]] WorldBox realigned_box(const Kdop<18>& dop, const Pose& world_from_shape);

}  // namespace peerd::collision
