#pragma once
#include <span>

#include "core/math.hpp"

namespace peerd::vrml {

// Returns the unit quaternion of an SFRotation (axis, angle [rad]). Its bits are the same on every computer: the sine
// of the C library may differ in the last place from one version to the next, and peers would not agree on where things
// touch. The error is below 1e-15 for |angle| <= 2 pi; it grows by 2.5e-16 with each further turn. An axis of length 0
// gives identity.
[[nodiscard]] Quat to_quat(std::span<const float, 4> rotation);

}  // namespace peerd::vrml
