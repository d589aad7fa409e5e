#pragma once
#include "collision/tree/kdop.hpp"
#include "core/box.hpp"
#include "core/geometry/mesh.hpp"

namespace peerd::collision {

// The thesis's box of a moved object (3.2.3), for collision type BOX: that of an 18-DOP that is made once, in the
// Shape's frame, and realigned to the world's axes wherever the Shape stands. No vertex is read then; the box is larger
// than the vertices' own.

// The 18-DOP of the vertices that polygons use, each multiply(stretch, vertex); empty where there are none.
[[nodiscard]] Kdop<18> dop_of(const Mesh& mesh, const Mat3& stretch);
[[nodiscard]] WorldBox realigned_box(const Kdop<18>& dop, const Pose& world_from_shape);

}  // namespace peerd::collision
