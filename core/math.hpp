#pragma once
#include <Eigen/Geometry>

namespace peerd {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;

// A Pose is a rigid transform, binary64: it maps p_body to orientation * p_body + position.
struct Pose {
  Vec3 position = Vec3::Zero();         // [m]
  Quat orientation = Quat::Identity();  // unit
  [[nodiscard]] Vec3 operator*(const Vec3& p_body) const { return orientation * p_body + position; }
};

// Returns exp of the pure quaternion (0, rotation/2): the rotation by |rotation| radians about the direction of the
// vector. There is no blow-up as |rotation| -> 0: sin(x/2)/x comes from its series there.
[[nodiscard]] Quat quat_exp(const Vec3& rotation_rad);

// Returns the smallest angle that turns a into b [rad], in [0, pi]. Both must be unit; q and -q are the same
// orientation.
[[nodiscard]] double angle_between(const Quat& a, const Quat& b);

}  // namespace peerd
