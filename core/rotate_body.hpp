#pragma once
#include "core/math.hpp"

namespace peerd {

// The orientation turned by a rotation in the frame of what is turned: orientation * quat_exp(rotation), of unit length
// where the orientation is but for roundings; else normalised.
[[nodiscard]] Quat rotated_in_body_frame(const Quat& orientation, const Vec3& rotation_body_rad);

}  // namespace peerd
