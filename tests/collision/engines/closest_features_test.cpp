#include "collision/engines/closest_features.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision/exact/triangle_distance.hpp"
#include "tests/collision/engines/convex_soups.hpp"

namespace peerd::collision::engines::closest_features_test {

struct Walked {
  bool apart = false;
  ClosestFeatures features;
  double distance_m = 0.0;  // of the faces, by an algorithm of its own
};

std::vector<Vec3> moved(const TriangleSoup& soup, const RelativeMotion& motion) {
  std::vector<Vec3> out;
  for (const Vec3& v : soup.vertices) out.push_back(motion(v));
  return out;
}

double distance_of_faces(const TriangleSoup& a, const TriangleSoup& b, const std::vector<Vec3>& moved_b) {
  double least = 1e300;
  for (std::uint32_t i = 0; i < a.faces.size(); ++i) {
    for (const TriangleSoup::Face& face : b.faces) {
      const Triangle t{moved_b[face.corners[0]], moved_b[face.corners[1]], moved_b[face.corners[2]]};
      least = std::min(least, triangle_distance(a.triangle(i), t).distance);
    }
  }
  return least;
}

// Whether a point of one is inside the other is not a question here: the poses leave no surface inside.
TEST(ClosestFeatures, SayApartWhereFacesAre) {
  const TriangleSoup a = spindle(7), b = closed_box({0.4, 0.9, 0.2});
  const auto piece_a = convex_pieces(a), piece_b = convex_pieces(b);
  Numbers numbers(3);
  int apart = 0;
  FeatureWalk walk;
  for (int i = 0; i < 2000; ++i) {
    const auto at = moved(b, RelativeMotion(Pose{}, random_pose(numbers, 1.6)));
    ClosestFeatures features;
    const bool found = walk.apart({piece_a[0], a.vertices}, {piece_b[0], at}, 1e-11, features);
    const double distance_m = distance_of_faces(a, b, at);
    apart += found;
    if (found) {
      ASSERT_GT(distance_m, 0.0) << i;
      ASSERT_LE(features.count, 3u) << i;
    } else if (distance_m > 1e-6) {  // one is inside the other
      bool inside = true;
      for (const Vec3& p : at) inside = inside && p.cwiseAbs().maxCoeff() < 1.0;
      ASSERT_TRUE(inside) << i;
    }
  }
  EXPECT_GT(apart, 500);
  EXPECT_LT(apart, 1900);
}

TEST(ClosestFeatures, OfTwoBoxesFaceToFaceAreFaces) {
  const TriangleSoup a = closed_box({1, 1, 1}), b = closed_box({0.5, 0.5, 0.5}, {0.1, 0.2, 2.0});
  const auto piece_a = convex_pieces(a), piece_b = convex_pieces(b);
  ClosestFeatures features;
  FeatureWalk walk;
  EXPECT_TRUE(walk.apart({piece_a[0], a.vertices}, {piece_b[0], b.vertices}, 1e-11, features));
  for (std::size_t i = 0; i < features.count; ++i) {
    EXPECT_EQ(a.vertices[piece_a[0].vertices[features.corners[i].a]][2], 1.0);
    EXPECT_EQ(b.vertices[piece_b[0].vertices[features.corners[i].b]][2], 1.5);
  }
}

// The paper's point: of two that have moved little the features are the last ones or beside them.
TEST(ClosestFeatures, OfALittleMotionAreNearTheLastOnes) {
  const TriangleSoup a = spindle(100), b = spindle(80);
  const auto piece_a = convex_pieces(a), piece_b = convex_pieces(b);
  ASSERT_EQ(piece_a.size() + piece_b.size(), 2u);
  std::uint64_t cold = 0, warm = 0;
  ClosestFeatures kept;
  FeatureWalk walk;
  for (int i = 0; i < 100; ++i) {
    const Pose pose{Vec3(2.2 + 0.001 * i, 0.3, 0.1), quat_exp(Vec3(0.002 * i, 0.001 * i, 0.003 * i))};
    const auto at = moved(b, RelativeMotion(Pose{}, pose));
    ClosestFeatures fresh;
    const std::uint64_t before = walk.steps();
    EXPECT_TRUE(walk.apart({piece_a[0], a.vertices}, {piece_b[0], at}, 1e-11, fresh));
    const std::uint64_t between = walk.steps();
    EXPECT_TRUE(walk.apart({piece_a[0], a.vertices}, {piece_b[0], at}, 1e-11, kept));
    if (i == 0) continue;  // nothing is known yet
    cold += between - before;
    warm += walk.steps() - between;
  }
  EXPECT_GT(warm, 0u);
  EXPECT_LT(3 * warm, cold);
}

}  // namespace peerd::collision::engines::closest_features_test
