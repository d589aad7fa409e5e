#include "collision/tree/realigned_box.hpp"

#include <gtest/gtest.h>

#include "collision/exact/triangle_soup.hpp"
#include "tests/collision/shapes.hpp"
#include "tests/collision/soups.hpp"

namespace peerd::collision::realigned_box_test {

using namespace test;

Mesh random_mesh(Numbers& numbers) {
  std::vector<Eigen::Vector3f> vertices;
  for (int i = 0; i < 12; ++i) vertices.push_back(numbers.point(2.0).cast<float>());
  return make_mesh(vertices, {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}});  // the last three vertices are used by no polygon
}

TEST(RealignedBox, HoldsTheMovedVerticesOfPolygons) {
  Numbers numbers(71);
  for (int i = 0; i < 300; ++i) {
    const Mesh mesh = random_mesh(numbers);
    const Mat3 stretch = i % 2 == 0 ? Mat3::Identity() : Mat3(Vec3(1.5, 0.5, 2.0).asDiagonal());
    const Pose pose = random_pose(numbers, i % 3 == 0 ? 1e6 : 3.0);
    const WorldBox box = realigned_box(dop_of(mesh, stretch), pose);
    const Mat3 rotation = pose.orientation.toRotationMatrix();
    for (std::size_t v = 0; v < 9; ++v) {
      const Vec3 p = multiply(rotation, multiply(stretch, Vec3(mesh.vertices[v].cast<double>()))) + pose.position;
      ASSERT_TRUE(box.contains(p)) << i;
    }
  }
}

// With no rotation the box is the vertices' own, but for the padding; what no polygon uses is not in it.
TEST(RealignedBox, IsTightWithoutRotation) {
  Numbers numbers(72);
  const Mesh mesh = random_mesh(numbers);
  WorldBox tight;
  for (std::size_t v = 0; v < 9; ++v) tight.merge(Vec3(mesh.vertices[v].cast<double>()));
  const WorldBox box = realigned_box(dop_of(mesh, Mat3::Identity()), Pose{});
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(box.lo[k], tight.lo[k], 1e-6);
    EXPECT_NEAR(box.hi[k], tight.hi[k], 1e-6);
  }
}

// A corner that is far along the diagonal is no farther along the axes.
TEST(RealignedBox, ItsPaddingIsThatOfTheLargestCoordinate) {
  const auto box = [](float sign) {
    const Mesh mesh = make_mesh({{0.9F, 0.9F * sign, 0}, {0.3F, 0.2F * sign, 0.1F}, {0, 0, 0}}, {{0, 1, 2}});
    return realigned_box(dop_of(mesh, Mat3::Identity()), Pose{});
  };
  EXPECT_EQ(box(1.0F).hi[0], box(-1.0F).hi[0]);
  EXPECT_EQ(box(1.0F).lo[0], box(-1.0F).lo[0]);
  EXPECT_EQ(box(1.0F).hi[2], box(-1.0F).hi[2]);
}

TEST(RealignedBox, OfNoPolygonIsEmpty) {
  EXPECT_TRUE(realigned_box(dop_of(make_mesh({{1, 2, 3}}, {}), Mat3::Identity()), Pose{}).is_empty());
}

}  // namespace peerd::collision::realigned_box_test
