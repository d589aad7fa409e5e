#include "collision/query/wide_query.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "collision/exact/triangle_pair.hpp"
#include "tests/collision/soups.hpp"

namespace peerd::collision::wide_query_test {

using ::testing::ElementsAreArray;

struct Case {
  TriangleSoup a, b;
  RelativeMotion motion;
};

std::vector<Case> cases() {
  Numbers numbers(31);
  std::vector<Case> out;
  const auto motion = [&](double distance) {
    return RelativeMotion(random_pose(numbers, distance), random_pose(numbers, distance));
  };
  for (int i = 0; i < 6; ++i) {
    out.push_back({random_soup(300, 0.1, 40), torus(16, 20, true), motion(0.7)});
    out.push_back({torus(16, 20, false), torus(7, 9, false), motion(1.0)});
    out.push_back({random_soup(700, 0.02, 41), random_soup(5, 0.9, 42), motion(0.5)});
  }
  // The soups are on top of each other: coplanar and equal triangles everywhere.
  out.push_back({torus(10, 12, true), torus(10, 12, true), RelativeMotion(Pose{}, Pose{})});
  // The soups are far from the world's origin, and from their own.
  Pose here = random_pose(numbers, 0.1), there = here;
  here.position += Vec3(1e6, -2e6, 3e6);
  there.position += Vec3(1e6 + 0.5, -2e6, 3e6);
  out.push_back({torus(10, 12, true), torus(10, 12, true), RelativeMotion(here, there)});
  TriangleSoup far = torus(10, 12, true);
  for (Vec3& v : far.vertices) v += Vec3(4096, 0, 0);
  find_box(far);
  out.push_back({far, torus(10, 12, true), RelativeMotion(Pose{}, Pose{{4096.25, 0, 0}, Quat::Identity()})});
  return out;
}

void scale(TriangleSoup& soup, double factor) {
  for (Vec3& v : soup.vertices) v *= factor;
  find_box(soup);
}

TEST(WideQuery, AllPairsAreThoseOfBruteForce) {
  WideQuery query;
  for (const Case& c : cases()) {
    WideTree a(c.a), b(c.b);
    const std::vector<PolygonPair> expected = brute_force(c.a, c.b, c.motion);
    EXPECT_THAT(query.all_pairs(a, b, c.motion), ElementsAreArray(expected));
    PolygonPair pair{};
    EXPECT_EQ(query.find_pair(a, b, c.motion, pair), !expected.empty());
    EXPECT_TRUE(expected.empty() || std::ranges::binary_search(expected, pair));
  }
}

TEST(WideQuery, AnyWithinIsWhetherThereAreFacesWithin) {
  WideQuery query;
  std::size_t near = 0, far = 0, touching = 0;
  for (const Case& c : cases()) {
    WideTree a(c.a), b(c.b);
    for (const double aside : {0.0, 0.3, 1.0, 2.0, 4.0}) {
      const RelativeMotion moved(Pose{Vec3(aside, 0.0, 0.0), Quat::Identity()}, Pose{});
      for (const RelativeMotion& motion : {c.motion, moved}) {
        for (const double distance_m : {0.0, 1e-6, 0.1, 1.0}) {
          const bool any = query.any_within(a, b, motion, distance_m);
          EXPECT_EQ(any, !query.faces_within(a, b, motion, distance_m).empty());
          (any ? near : far) += distance_m > 0.0;
          touching += any && distance_m == 0.0;
        }
      }
    }
  }
  EXPECT_GT(near, 0);
  EXPECT_GT(far, 0);
  EXPECT_GT(touching, 0);
}

TEST(WideQuery, SizesFromDenormalToAHundredDigitsAreTheSame) {
  WideQuery query;
  for (const double factor : {0x1p-1040, 0x1p-300, 0x1p-130, 0x1p-60, 0x1p60, 0x1p99, 0x1p126}) {
    std::vector<Case> all = cases();
    const bool subnormal = factor < 0x1p-500;  // integers are slow: small cases only
    for (std::size_t i = subnormal ? 2 : 0; i < all.size(); i += subnormal ? 6 : 4) {
      Case& c = all[i];
      if (c.a.box.hi.cwiseAbs().maxCoeff() > 2.0) continue;
      scale(c.a, factor);
      scale(c.b, factor);
      c.motion.translation *= factor;
      WideTree a(c.a), b(c.b);
      EXPECT_THAT(query.all_pairs(a, b, c.motion), ElementsAreArray(brute_force(c.a, c.b, c.motion))) << factor;
    }
  }
}

TEST(WideQuery, HalfSpacesMeetSmallThingsAndEachOther) {
  const TriangleSoup large = half_space(), small = torus(6, 8, false);
  WideTree a(large), b(small), c(large);
  WideQuery query;
  Numbers numbers(33);
  for (int i = 0; i < 30; ++i) {
    const RelativeMotion motion(random_pose(numbers, 1.0), random_pose(numbers, 1.0));
    EXPECT_THAT(query.all_pairs(a, b, motion), ElementsAreArray(brute_force(large, small, motion)));
    EXPECT_THAT(query.all_pairs(b, a, motion), ElementsAreArray(brute_force(small, large, motion)));
    EXPECT_THAT(query.all_pairs(a, c, motion), ElementsAreArray(brute_force(large, large, motion)));
  }
}

TEST(WideQuery, RefittedTreesFollowTheirVertices) {
  const TriangleSoup other = random_soup(150, 0.2, 9);
  for (const bool whole : {false, true}) {
    TriangleSoup soup = torus(12, 40, true);
    WideTree moving(soup), still(other);
    WideQuery query;
    const RelativeMotion motion(Pose{}, Pose{{0.9, 0, 0}, Quat::Identity()});
    (void)query.all_pairs(moving, still, motion);  // built in part
    if (whole) moving.build_all();
    for (Vec3& v : soup.vertices) v = {1.5 * v[0] + 3.0, v[1] + 0.3 * v[0] * v[0], v[2] + 0.5};
    find_box(soup);
    moving.refit();
    const RelativeMotion next(Pose{}, Pose{{3.9, 0.2, 0.4}, Quat::Identity()});
    const std::vector<PolygonPair> expected = brute_force(soup, other, next);
    EXPECT_FALSE(expected.empty());
    EXPECT_THAT(query.all_pairs(moving, still, next), ElementsAreArray(expected));
  }
}

TEST(WideQuery, BuildsOnlyWhatItVisits) {
  const TriangleSoup soup = torus(64, 128, false);
  WideTree a(soup), b(soup);
  WideQuery query;
  PolygonPair pair{};
  Pose far;
  far.position = {10.0, 0.0, 0.0};
  EXPECT_FALSE(query.find_pair(a, b, RelativeMotion(Pose{}, far), pair));
  EXPECT_EQ(a.nodes_built(), 1u);
  EXPECT_EQ(query.counters().triangle_tests, 0u);
  Pose near;
  near.position = {1.9, 0.0, 0.0};
  EXPECT_TRUE(query.find_pair(a, b, RelativeMotion(Pose{}, near), pair));
  const std::size_t visited = a.nodes_built();
  a.build_all();
  EXPECT_LT(10 * visited, a.nodes_built());
}

// The normal of a triangle of 1e-22 m is a few of binary32's least numbers: no plane separates by it.
TEST(WideQuery, FindsWhatATinyTriangleTouches) {
  constexpr double e = 0x1p-73;
  TriangleSoup tiny, large;
  tiny.vertices = {{0, 0, 0}, {e, -e, 0}, {0, e, -e}};
  large.vertices = {{0.350585938, -0.310546875, -0.0537109375},
                    {-0.295898438, 0.709960938, -0.419921875},
                    {-0.0546875, -0.399414062, 0.473632812}};
  for (TriangleSoup* soup : {&tiny, &large}) {
    for (Vec3& v : soup->vertices) soup->box.merge(v = v.cast<float>().cast<double>());
    soup->faces.push_back({{0, 1, 2}, 0});
  }
  OrientationCounters counters;
  Numbers numbers(91);
  int touching = 0;
  for (int i = 0; i < 20000; ++i) {
    // Planes through, or very near to, the tiny one.
    TriangleSoup turned = large;
    if (i > 0) {
      turned.box = {};
      const Vec3 normal = numbers.point(1.0).normalized(), u = normal.unitOrthogonal(), v = normal.cross(u);
      turned.vertices = {u, -0.5 * u + 0.8 * v, -0.5 * u - 0.8 * v};
      for (Vec3& p : turned.vertices) turned.box.merge(p = p.cast<float>().cast<double>());
    }
    WideTree a(tiny), b(turned);
    WideQuery query;
    PolygonPair pair{};
    const RelativeMotion here{Pose{}, Pose{}};
    const bool truth = touch(tiny.triangle(0), turned.triangle(0), counters);
    touching += truth;
    ASSERT_EQ(query.find_pair(a, b, here, pair), truth) << i;
  }
  EXPECT_GT(touching, 0);
}

}  // namespace peerd::collision::wide_query_test
