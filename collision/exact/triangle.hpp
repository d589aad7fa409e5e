#pragma once
#include <array>

#include "core/math.hpp"

namespace peerd::collision {

// The closed convex hull of three points of one frame [m]: with collinear corners a segment, with equal ones a point.
using Triangle = std::array<Vec3, 3>;

}  // namespace peerd::collision
