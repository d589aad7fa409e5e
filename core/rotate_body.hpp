#pragma once
#include "core/math.hpp"

namespace peerd {

// Returns the orientation turned by a rotation in the frame of the body: orientation * quat_exp(rotation). It has unit
// length where the orientation has, but for roundings; otherwise it is normalised.
[[nodiscard]] Quat rotated_in_body_frame(const Quat& orientation, const Vec3& rotation_body_rad);

}  // namespace peerd
