#include "collision/exact/overlap_depth.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "tests/collision/oracle_types.hpp"
#include "tests/collision/soups.hpp"
#include "tests/oracle/triangle_cases.hpp"

namespace peerd::collision::overlap_depth_test {

bool touch(const Triangle& a, const Triangle& b) { return oracle::touch(plain(a), plain(b)); }

const Triangle kFloor = {Vec3(0, 0, 0), Vec3(8, 0, 0), Vec3(0, 8, 0)};

struct Case {
  const char* name;
  Triangle a, b;
  double depth;
};
class OverlapDepth : public testing::TestWithParam<Case> {};
TEST_P(OverlapDepth, IsThatOfTheTable) {
  const auto& [name, a, b, depth] = GetParam();
  for (const double found : {overlap_depth_m(a, b), overlap_depth_m(b, a)}) {
    EXPECT_LE(found, depth);
    EXPECT_NEAR(found, depth, 1e-9);
  }
}
INSTANTIATE_TEST_SUITE_P(
    Table, OverlapDepth,
    testing::Values(Case{"Apart", kFloor, {Vec3(1, 1, 1), Vec3(2, 1, 1), Vec3(1, 2, 1)}, 0.0},
                    Case{"TouchesOnly", kFloor, {Vec3(1, 1, 0), Vec3(2, 1, 1), Vec3(1, 2, 1)}, 0.0},
                    Case{"OnePlane", kFloor, {Vec3(1, 1, 0), Vec3(2, 1, 0), Vec3(1, 2, 0)}, 0.0},
                    Case{"Itself", kFloor, kFloor, 0.0},
                    Case{"TipBelow", kFloor, {Vec3(2, 2, -0.5), Vec3(2, 3, 9), Vec3(3, 2, 9)}, 0.5},
                    // A wall through the floor, 1 m from its edge; its own edges are farther.
                    Case{"NearAnEdge", kFloor, {Vec3(3, 1, -50), Vec3(4, 1, 50), Vec3(2, 1, 50)}, 1.0},
                    Case{"ParallelEdges", kFloor, {Vec3(1, 2, -1), Vec3(2, 2, -1), Vec3(1, 2, 90)}, 1.0},
                    Case{"Segment", kFloor, {Vec3(2, 2, -1), Vec3(2, 2, 3), Vec3(2, 2, 2)}, 1.0},
                    Case{"TwoSegments",
                         {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 0, 0)},
                         {Vec3(1, -1, 0), Vec3(1, 1, 0), Vec3(1, 1, 0)},
                         0.0},
                    Case{"OneLine",
                         {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 0, 0)},
                         {Vec3(1, 0, 0), Vec3(3, 0, 0), Vec3(3, 0, 0)},
                         0.0},
                    Case{"Point", kFloor, {Vec3(1, 1, 0), Vec3(1, 1, 0), Vec3(1, 1, 0)}, 0.0},
                    Case{"Points",
                         {Vec3(1, 1, 0), Vec3(1, 1, 0), Vec3(1, 1, 0)},
                         {Vec3(1, 1, 0), Vec3(1, 1, 0), Vec3(1, 1, 0)},
                         0.0}),
    [](const auto& test) { return std::string(test.param.name); });

// The unit direction, of all 11 axes and both of their senses, along which A has the least way out of B.
Vec3 way_out(const Triangle& a, const Triangle& b) {
  double least = std::numeric_limits<double>::infinity();
  Vec3 out = Vec3::Zero();
  const auto consider = [&](const Vec3& u, const Vec3& v) {
    const Vec3 n = u.cross(v);
    if (n.norm() < 1e-12 * u.norm() * v.norm() || n.norm() == 0.0) return;
    for (const Vec3& direction : {Vec3(n.normalized()), Vec3(-n.normalized())}) {
      double most = -std::numeric_limits<double>::infinity();
      for (const Vec3& p : a) {
        for (const Vec3& q : b) most = std::max(most, direction.dot(p - q));
      }
      if (most < least) {
        least = most;
        out = -direction;
      }
    }
  };
  consider(a[1] - a[0], a[2] - a[0]);
  consider(b[1] - b[0], b[2] - b[0]);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) consider(a[(i + 1) % 3] - a[i], b[(j + 1) % 3] - b[j]);
  }
  return out;
}

Triangle displaced(const Triangle& t, const Vec3& by) { return {t[0] + by, t[1] + by, t[2] + by}; }

// Displaces the corners of A by nearly the depth, and of A and B by nearly half of it each, in directions of their own.
void expect_still_touching(const Triangle& a, const Triangle& b, double depth, Numbers& numbers) {
  const auto off = [&](double length) {
    const Vec3 direction = numbers.point(1.0);
    return Vec3(direction * (length / direction.norm()));
  };
  const double just_less = depth * (1.0 - 1e-9);
  for (int n = 0; n < 8; ++n) {
    Triangle c = a, d = a, e = b;
    for (std::size_t i = 0; i < 3; ++i) {
      c[i] += off(just_less);
      d[i] += off(just_less / 2);
      e[i] += off(just_less / 2);
    }
    ASSERT_TRUE(touch(c, b));
    ASSERT_TRUE(touch(d, e));
  }
  ASSERT_TRUE(touch(displaced(a, way_out(a, b) * just_less), b));
}

TEST(OverlapDepth, IsTightForGeneralPairs) {
  Numbers numbers(111);
  int deep = 0;
  for (int i = 0; i < 4000; ++i) {
    Triangle a, b;
    for (Triangle* t : {&a, &b}) {
      for (Vec3& p : *t) p = numbers.point(1.0);
    }
    if (i % 4 == 1) b[1] = b[0] + (a[1] - a[0]) * 0.7;                         // edges in parallel but for rounding
    if (i % 4 == 2) b[1] = b[0] + (a[1] - a[0]) * 0.7 + numbers.point(1e-10);  // and nearly so
    if (i % 4 == 3) a[2] = a[0] + (a[1] - a[0]) * numbers.unit() + numbers.point(1e-3);  // a needle
    const double depth = overlap_depth_m(a, b);
    ASSERT_GE(depth, 0.0);
    ASSERT_EQ(overlap_depth_m(b, a), depth) << i;
    if (!touch(a, b)) {
      ASSERT_EQ(depth, 0.0) << i;
      continue;
    }
    ++deep;
    ASSERT_FALSE(touch(displaced(a, way_out(a, b) * (depth + 1e-9)), b)) << i;
    if (depth > 1e-6) {
      ASSERT_NO_FATAL_FAILURE(expect_still_touching(a, b, depth, numbers)) << i;
    }
  }
  EXPECT_GT(deep, 500);
  RecordProperty("touching", deep);
}

TEST(OverlapDepth, IsCertainForAdversarialPairs) {
  oracle::Rng rng(112);
  Numbers numbers(113);
  int deep = 0;
  for (const auto& generators : {oracle::general(), oracle::adversarial()}) {
    for (const oracle::Generator& generator : generators) {
      for (int i = 0; i < 100; ++i) {
        const oracle::Pair pair = generator.make(rng);
        const Triangle a = ours(pair.a), b = ours(pair.b);
        double largest = 0.0;
        for (const Triangle* t : {&a, &b}) {
          for (const Vec3& p : *t) largest = std::max(largest, p.cwiseAbs().maxCoeff());
        }
        if (largest > 0x1p128) continue;
        const double depth = overlap_depth_m(a, b);
        ASSERT_TRUE(std::isfinite(depth) && depth >= 0.0) << generator.name;
        if (!oracle::touch(pair.a, pair.b)) {
          ASSERT_EQ(depth, 0.0) << generator.name;
        }
        // Displacements that rounding of the corners leaves some room for.
        if (depth <= 0x1p-40 * largest) continue;
        ++deep;
        ASSERT_NO_FATAL_FAILURE(expect_still_touching(a, b, depth * (1.0 - 1e-3), numbers)) << generator.name;
      }
    }
  }
  EXPECT_GT(deep, 500);
  RecordProperty("touching", deep);
}

}  // namespace peerd::collision::overlap_depth_test
