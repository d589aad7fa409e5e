#pragma once
#include <array>
#include <span>

#include "core/math.hpp"

namespace peerd {

// TransformFields are the fields of a Transform (VRML97 6.52): p_parent = T * C * R * SR * S * SR^-1 * C^-1 * p_local.
// Lengths are in metres, rotations are unit.
struct TransformFields {
  Vec3 translation = Vec3::Zero();
  Quat rotation = Quat::Identity();
  Vec3 scale = Vec3::Ones();
  Quat scale_orientation = Quat::Identity();
  Vec3 center = Vec3::Zero();
};

// The fields that place a Transform in its parent, as a file has them: metres; an axis and an angle in radians.
struct Placement {
  std::array<float, 3> translation{};
  std::array<float, 4> rotation{0, 0, 1, 0};

  friend bool operator==(const Placement&, const Placement&) = default;
};

[[nodiscard]] inline bool is_scaled(const TransformFields& t) { return t.scale != Vec3::Ones(); }

// These products are written out, summed from left to right, since peers must get the same bits: Eigen chooses the
// order of its sums, and whether to fuse them, by instruction set.
[[nodiscard]] Vec3 multiply(const Mat3& m, const Vec3& v);
[[nodiscard]] Mat3 multiply(const Mat3& a, const Mat3& b);
[[nodiscard]] Quat multiply(const Quat& a, const Quat& b);
[[nodiscard]] Quat normalized(const Quat& q);

// An Affine maps p to linear * p + offset.
struct Affine {
  Mat3 linear = Mat3::Identity();
  Vec3 offset = Vec3::Zero();
};

[[nodiscard]] Affine multiply(const Affine& a, const Affine& b);

// Returns T * C * R * SR * S * SR^-1 * C^-1. Without scale SR and its inverse cancel and are left out, so that R stays
// a rotation to the last bit.
[[nodiscard]] Affine parent_from_local(const TransformFields& t);

// Returns the rigid part of a path of transforms, from the top: where the origin of the last one is, and the product of
// the rotations.
[[nodiscard]] Pose rigid_pose(std::span<const TransformFields> path);
// Returns the same in the rigid frame of what stands above the path, and stretches it (StretchedPose::stretch).
[[nodiscard]] Pose rigid_pose(const Mat3& stretch, std::span<const TransformFields> path);

// A rigid pose with the matrix that scales and shears the rest of the path: the linear part of the product of the path
// is rotation * stretch. The stretch is exactly the identity without scale, and exactly the scale where only the last
// transform has one. With R_i and S_i the rotation and the scale (SR * S * SR^-1) of transform i, stretch_i = (R_i^T *
// stretch_(i-1) * R_i) * S_i.
struct StretchedPose {
  Pose pose;
  Mat3 stretch = Mat3::Identity();
};
[[nodiscard]] StretchedPose stretched_pose(std::span<const TransformFields> path);

}  // namespace peerd
