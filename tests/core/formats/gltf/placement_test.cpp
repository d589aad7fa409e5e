#include "core/formats/gltf/placement.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/scene/rotation.hpp"
#include "core/transform.hpp"

namespace peerd::formats::gltf::placement_test {
namespace {

// The matrix that a Transform with those values applies.
Eigen::Matrix3d linear_of(const TransformValues& v) {
  TransformFields fields;
  fields.rotation = vrml::to_quat(v.rotation);
  fields.scale_orientation = vrml::to_quat(v.scale_orientation);
  fields.scale = Vec3(v.scale[0], v.scale[1], v.scale[2]);
  return parent_from_local(fields).linear;
}

void expect_the_map(const Eigen::Matrix3d& m) {
  std::array<double, 16> columns{};
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) columns[static_cast<std::size_t>(4 * c + r)] = m(r, c);
  }
  columns[15] = 1.0;
  EXPECT_LT((linear_of(transform_of(columns)) - m).norm(), 2e-6 * std::max(m.norm(), 1e-30)) << m;
}

TEST(TransformOf, IsAnyLinearMap) {
  std::mt19937 random(7);
  std::normal_distribution<double> number;
  for (int i = 0; i < 2000; ++i) {
    Eigen::Matrix3d m;
    for (int k = 0; k < 9; ++k) m(k / 3, k % 3) = number(random);
    if (i % 4 == 1) m.col(0) *= 1e-3;
    if (i % 4 == 2) m.row(1).setZero();
    if (i % 16 == 3) m = Eigen::Matrix3d::Zero();
    if (i % 16 == 7) m = (m.col(0) * Eigen::RowVector3d::Constant(number(random))).eval();  // of rank 1
    expect_the_map(m);
  }
}

TEST(TransformOf, OfAMirrorImageHasNoMoreRotationThanItNeeds) {
  const std::array<double, 16> columns{-2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0, 7, 8, 9, 1};
  const TransformValues values = transform_of(columns);
  EXPECT_EQ(values.scale, (std::array<float, 3>{-2, 3, 4}));
  EXPECT_EQ(values.rotation[3], 0.0F);
  EXPECT_EQ(values.scale_orientation[3], 0.0F);
  EXPECT_EQ(values.translation, (std::array<float, 3>{7, 8, 9}));
}

TEST(AxisAngle, IsTheQuaternionsWhateverItsLengthAndSign) {
  EXPECT_EQ(axis_angle(std::array<double, 4>{0, 0, 0, 0}), (std::array<float, 4>{0, 0, 1, 0}));
  const auto turn = axis_angle(std::array<double, 4>{0, 0, -2, 2});
  EXPECT_EQ(turn, axis_angle(std::array<double, 4>{0, 0, 1, -1}));
  EXPECT_FLOAT_EQ(turn[3], 1.5707964F);
  EXPECT_EQ(turn[2], -1.0F);
}

}  // namespace
}  // namespace peerd::formats::gltf::placement_test
