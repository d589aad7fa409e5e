#include "collision/engines/sphere_volume.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "tests/collision/soups.hpp"

namespace peerd::collision::engines::sphere_volume_test {

TEST(Sphere, IsAroundItsTrianglesAndHardlyLarger) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const TriangleSoup soup = random_soup(1 + seed % 40, 0.5, seed);
    std::vector<std::uint32_t> faces(soup.faces.size());
    std::iota(faces.begin(), faces.end(), 0u);
    const Sphere sphere = Sphere::around(soup, faces);
    double farthest = 0.0;
    for (const TriangleSoup::Face& face : soup.faces) {
      for (const std::uint32_t corner : face.corners) {
        farthest = std::max(farthest, (soup.vertices[corner] - sphere.center).norm());
      }
    }
    EXPECT_LE(farthest, sphere.radius_m);
    EXPECT_NEAR(farthest, sphere.radius_m, 1e-9);
  }
}

TEST(Sphere, TellsSpheresApart) {
  Sphere a, b;
  a.radius_m = b.radius_m = 1.0;
  Pose pose;
  pose.position = {2.001, 0, 0};
  EXPECT_FALSE(Sphere::Test(RelativeMotion(Pose{}, pose), 1.0, 1.0)(a, b));
  pose.position = {1.999, 0, 0};
  EXPECT_TRUE(Sphere::Test(RelativeMotion(Pose{}, pose), 1.0, 1.0)(a, b));
}

}  // namespace peerd::collision::engines::sphere_volume_test
