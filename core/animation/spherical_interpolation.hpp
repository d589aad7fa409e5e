#pragma once
#include "core/math.hpp"

namespace peerd::animation {

// These functions compute great arcs by operations that give the same bits everywhere (sin_cos, atan2, written-out
// sums).

// Returns the unit quaternion of an SFRotation. `axis` need not be unit, one of length 0 gives identity; angle [rad].
[[nodiscard]] Quat quat_from_axis_angle(const Vec3& axis, double angle_rad);

// Returns the rotation vector r [rad], in the own frame of a, with a * exp(r / 2) = b or -b and |r| <= pi + 2^-22: the
// shorter way from a to b. Of two ways of equal length (opposite orientations, whose result 6.32 leaves undefined), it
// is the one about the vector part of conj(a) * b: forwards, where a and b are angles about one axis. A half turn in a
// file is 3.14159265, which binary32 rounds to more than pi: angles within 2^-22 rad of half a turn count as one. The
// error is below 2e-15.
[[nodiscard]] Vec3 rotation_between(const Quat& a, const Quat& b);

// Returns `a` turned by r [rad], which is given in the own frame of a: a * exp(r / 2). The result is unit to 3e-16; its
// error is below 2e-15 for |r| <= 2 pi.
[[nodiscard]] Quat rotated_in_body_frame(const Quat& a, const Vec3& r);

// Returns the point at `fraction` of the shorter arc from p to q, both of which should be unit; their lengths are
// interpolated too. Opposite points (undefined by 6.31) take an arc through the axis on which p is least. A vector of
// length 0 has no arc: the result is linear then.
[[nodiscard]] Vec3 slerp(const Vec3& p, const Vec3& q, double fraction);

}  // namespace peerd::animation
