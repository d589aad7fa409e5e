#pragma once
#include "core/math.hpp"

namespace peerd::animation {

// Great arcs, by operations that give the same bits everywhere (sin_cos, atan2, written-out sums).

// The unit quaternion of an SFRotation: `axis` need not be unit, one of length 0 gives identity; angle [rad].
[[nodiscard]] Quat quat_from_axis_angle(const Vec3& axis, double angle_rad);

// The rotation vector r [rad], in a's own frame, with a * exp(r / 2) = b or -b and |r| <= pi: the shorter way from a to
// b. Of two ways of equal length (opposite orientations, whose result 6.32 leaves undefined), the one about the vector
// part of conj(a) * b as its sign happens to be: some axis, the same on every machine. Error below 2e-15.
[[nodiscard]] Vec3 rotation_between(const Quat& a, const Quat& b);

// Returns `a` turned by r [rad], which is given in the own frame of a: a * exp(r / 2). The result is unit to 3e-16; its
// error is below 2e-15 for |r| <= 2 pi.
[[nodiscard]] Quat rotated_in_body_frame(const Quat& a, const Vec3& r);

// The point at `fraction` of the shorter arc from p to q, both of which should be unit; their lengths are interpolated
// too. Opposite points (undefined by 6.31) take an arc through the axis on which p is least. A vector of length 0 has
// no arc: linear then.
[[nodiscard]] Vec3 slerp(const Vec3& p, const Vec3& q, double fraction);

}  // namespace peerd::animation
