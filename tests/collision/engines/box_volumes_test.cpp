#include "collision/engines/box_volumes.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/collision/soups.hpp"

namespace peerd::collision::engines::box_volumes_test {

std::vector<std::uint32_t> all_faces(const TriangleSoup& soup) {
  std::vector<std::uint32_t> faces(soup.faces.size());
  std::iota(faces.begin(), faces.end(), 0u);
  return faces;
}

double volume(const Box& box) { return 8.0 * box.half.prod(); }

// A plate of 4 x 1 x 0.1 m, turned.
TriangleSoup plate(const Quat& turn) {
  TriangleSoup soup = closed_box({2.0, 0.5, 0.05});
  for (Vec3& v : soup.vertices) v = turn * v;
  find_box(soup);
  return soup;
}

// An OBB lies along what it is around, however that is turned (Gottschalk 1996, section 4).
TEST(OrientedBox, FitsATurnedPlate) {
  const TriangleSoup soup = plate(Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized())));
  const auto faces = all_faces(soup);
  EXPECT_NEAR(volume(OrientedBox::around(soup, faces)), 0.4, 1e-6);
  EXPECT_GT(volume(AlignedBox::around(soup, faces)), 2.0);
}

TEST(Boxes, ContainTheirTriangles) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const TriangleSoup soup = random_soup(1 + seed % 40, 0.5, seed);
    const auto faces = all_faces(soup);
    for (const Box& box : {Box(OrientedBox::around(soup, faces)), Box(AlignedBox::around(soup, faces))}) {
      for (const TriangleSoup::Face& face : soup.faces) {
        for (const std::uint32_t corner : face.corners) {
          const Vec3 along = box.orientation.transpose() * (soup.vertices[corner] - box.center);
          for (int i = 0; i < 3; ++i) EXPECT_LE(std::abs(along[i]), box.half[i]) << seed;
        }
      }
    }
  }
}

TEST(BoxTest, TellsBoxesApartThatOnlyACrossProductParts) {
  Box bar;
  bar.half = {1.0, 0.1, 0.1};
  Box other = bar;
  other.half = {0.1, 0.1, 1.0};
  Pose pose;
  // Two bars that cross at right angles: apart along y alone, then turned so that their own axes no longer tell.
  const auto apart = [&](double distance) {
    pose.position = {0, distance, 0};
    return !BoxTest(RelativeMotion(Pose{}, pose), 1.0, 1.0)(bar, other);
  };
  EXPECT_TRUE(apart(0.21));
  EXPECT_FALSE(apart(0.19));
  bar.orientation = Eigen::AngleAxisd(0.25 * 3.14159265358979, Vec3::UnitX()).toRotationMatrix();
  other.orientation = Eigen::AngleAxisd(0.25 * 3.14159265358979, Vec3::UnitZ()).toRotationMatrix();
  EXPECT_TRUE(apart(0.30)) << "two edges meet at 0.283";
  EXPECT_FALSE(apart(0.28));
}

TEST(OrientedBox, IsSomethingForTrianglesWithoutAnArea) {
  TriangleSoup line;
  line.vertices = {{0, 0, 0}, {1, 1, 0}, {2, 2, 0}};
  line.faces = {{{0, 1, 2}, 0}, {{1, 1, 1}, 1}};
  find_box(line);
  const auto faces = all_faces(line);
  const OrientedBox box = OrientedBox::around(line, faces);
  EXPECT_NEAR(box.half.maxCoeff(), std::sqrt(2.0), 1e-9);
  const std::vector<std::uint32_t> point{1};
  EXPECT_LT(OrientedBox::around(line, point).half.maxCoeff(), 1e-9) << "a point";
}

}  // namespace peerd::collision::engines::box_volumes_test
