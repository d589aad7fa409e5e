#pragma once
#include <array>
#include <span>

#include "core/math.hpp"

namespace tinygltf {
class Node;
}

namespace peerd::formats::gltf {

// The fields of a Transform [m, radians]: a point p goes to translation + R(rotation) * SR * scale * SR^-1 * p, where
// SR is the rotation scaleOrientation. Rotations are an axis and an angle.
struct TransformValues {
  std::array<float, 3> translation{}, scale{1, 1, 1};
  std::array<float, 4> rotation{0, 0, 1, 0}, scale_orientation{0, 0, 1, 0};
};

// Returns the axis and the angle [0, pi] of a quaternion x, y, z, w, which need not have length 1; none of it where it
// is zero.
[[nodiscard]] std::array<float, 4> axis_angle(std::span<const double, 4> quaternion);

// Splits an affine map into a rotation and a scale along orthogonal axes, by its polar decomposition M = R * P: P is
// the symmetric root of M^T * M, whose eigenvectors are the axes. A mirror image has negative scales. `columns` are the
// sixteen numbers of the matrix, column by column, as glTF has them.
[[nodiscard]] TransformValues transform_of(std::span<const double, 16> columns);

// Returns the linear part of a node's place in the world, for that of its parent. What is wrong with the node's numbers
// is found elsewhere.
[[nodiscard]] Mat3 linear_below(const Mat3& above, const tinygltf::Node& node);

}  // namespace peerd::formats::gltf
