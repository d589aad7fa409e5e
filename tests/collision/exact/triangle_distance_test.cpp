#include "collision/exact/triangle_distance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/collision/oracle_types.hpp"
#include "tests/collision/soups.hpp"
#include "tests/oracle/distance_oracle.hpp"
#include "tests/oracle/triangle_cases.hpp"

namespace peerd::collision::triangle_distance_test {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double largest(const Triangle& a, const Triangle& b) {
  double out = 0.0;
  for (std::size_t i = 0; i < 3; ++i) out = std::max({out, a[i].cwiseAbs().maxCoeff(), b[i].cwiseAbs().maxCoeff()});
  return out;
}

// Bounds hold, and are a few units in the last place of the largest coordinate apart; between 2^-200 and 2^250.
void expect_certain(const Triangle& a, const Triangle& b, const char* what) {
  const TriangleDistance found = triangle_distance(a, b);
  const mpq_class square = oracle::squared_distance(plain(a), plain(b));
  ASSERT_LE(squared(found.lower), square) << what << " " << found.lower << " " << std::sqrt(square.get_d());
  if (found.upper < kInfinity) {
    ASSERT_GE(squared(found.upper), square) << what;
  }
  ASSERT_EQ(found.upper == 0.0, square == 0) << what;
  const double size = largest(a, b);
  if (size > 0x1p-200 && size < 0x1p250) {
    ASSERT_LE(found.upper - found.lower, 0x1p-43 * size) << what << " " << found.lower << " " << found.upper;
    ASSERT_NEAR((found.on_b - found.on_a).norm(), found.distance, 0x1p-43 * size) << what;
    ASSERT_LE(found.distance, found.upper + 0x1p-43 * size) << what;
  }
}

TEST(TriangleDistance, BoundsAreCertainAndNarrow) {
  oracle::Rng rng(81);
  for (const auto& generators : {oracle::general(), oracle::adversarial()}) {
    for (const oracle::Generator& generator : generators) {
      for (int i = 0; i < 150; ++i) {
        const oracle::Pair pair = generator.make(rng);
        ASSERT_NO_FATAL_FAILURE(expect_certain(ours(pair.a), ours(pair.b), generator.name.data()));
      }
    }
  }
}

// Edges that pass at all small distances and angles: there, binary64 finds points that are off by angle times length.
TEST(TriangleDistance, NearlyParallelEdgesPass) {
  Numbers numbers(82);
  for (int i = 0; i < 3000; ++i) {
    const double angle = std::exp2(-numbers.between(1.0, 45.0)), gap = std::exp2(-numbers.between(1.0, 50.0));
    const Pose turned = random_pose(numbers, 1.0);
    const double x = numbers.between(0.1, 0.9);
    // Along x at height 0, and at a small angle to that above it, crossing at x; both are wedges that point at it.
    Triangle a = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, 0, -1)};
    Triangle b = {Vec3(0, -angle * x, gap), Vec3(1, angle * (1 - x), gap), Vec3(0.4, 0, gap + 1)};
    for (std::size_t k = 0; k < 3; ++k) a[k] = turned * a[k], b[k] = turned * b[k];
    ASSERT_NO_FATAL_FAILURE(expect_certain(a, b, "edges"));
    ASSERT_NO_FATAL_FAILURE(expect_certain(b, a, "edges"));
  }
}

TEST(TriangleDistance, CornersAreAboveNeedles) {
  Numbers numbers(83);
  for (int i = 0; i < 3000; ++i) {
    const double width = std::exp2(-numbers.between(1.0, 45.0)), gap = std::exp2(-numbers.between(1.0, 50.0));
    const Pose turned = random_pose(numbers, 1.0);
    Triangle a = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(numbers.between(-0.5, 1.5), width, 0)};
    const Vec3 p(numbers.between(0.1, 0.9), width * numbers.between(-0.5, 1.0), gap);
    Triangle b = {p, p + Vec3(0.1, 0.3, 1), p + Vec3(-0.2, 0.1, 1)};
    for (std::size_t k = 0; k < 3; ++k) a[k] = turned * a[k], b[k] = turned * b[k];
    ASSERT_NO_FATAL_FAILURE(expect_certain(a, b, "needle"));
  }
}

TEST(TriangleDistance, TrianglesThatCrossHaveACommonPoint) {
  const Triangle floor = {Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};
  const TriangleDistance through = triangle_distance(floor, {Vec3(1, 1, 1), Vec3(1, 1, -1), Vec3(9, 9, 0.5)});
  EXPECT_EQ(through.upper, 0.0);
  EXPECT_LT((through.on_a - through.on_b).norm(), 1e-15);
  EXPECT_LT(std::abs(through.on_a[2]), 1e-15);
  EXPECT_LE(through.on_a[0] + through.on_a[1], 4.0 + 1e-15);
}

}  // namespace peerd::collision::triangle_distance_test
