#include "collision/scene/pair_coherence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision/exact/triangle_distance.hpp"
#include "tests/collision/soups.hpp"

namespace peerd::collision::pair_coherence_test {

double distance(const TriangleSoup& a, const TriangleSoup& b, const RelativeMotion& a_from_b) {
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t g = 0; g < b.faces.size(); ++g) {
    const Triangle t = b.triangle(g);
    const Triangle moved = {a_from_b(t[0]), a_from_b(t[1]), a_from_b(t[2])};
    for (std::uint32_t f = 0; f < a.faces.size(); ++f) {
      least = std::min(least, triangle_distance(a.triangle(f), moved).distance);
    }
  }
  return least;
}

// Never more than the distance; and, as boxes and planes go, mostly not much less.
TEST(ApartBy, IsBelowTheDistance) {
  const TriangleSoup ring = torus(8, 16, true), crumbs = random_soup(60, 0.2, 5);
  WideQuery query;
  int apart = 0, found = 0;
  for (const TriangleSoup* soup : {&ring, &crumbs}) {
    WideTree a(ring), b(*soup);
    Numbers numbers(31);
    for (int i = 0; i < 100; ++i) {
      const RelativeMotion motion(random_pose(numbers, 2.0), random_pose(numbers, 2.0));
      const double truth = distance(ring, *soup, motion);
      EXPECT_FALSE(query.separated_by(a, b, motion, truth + 1e-12));  // triangle_distance() rounds, too
      if (truth == 0.0) continue;
      ++apart;
      found += query.separated_by(a, b, motion, 0.5 * truth);
    }
  }
  EXPECT_GT(apart, 80);
  EXPECT_GT(found, apart * 3 / 4);
}

// Flat to flat, boxes have the distance to the last bits of binary32: the next greater numbers are refused.
TEST(ApartBy, IsCertifiedWhereBoxesAreTight) {
  TriangleSoup plate;
  plate.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  plate.faces = {{{0, 1, 2}, 0}};
  find_box(plate);
  WideTree a(plate), b(plate);
  WideQuery query;
  Numbers numbers(8);
  for (int i = 0; i < 2000; ++i) {
    const double gap_m = std::exp2(numbers.between(-12, 3));
    RelativeMotion motion{Pose{}, Pose{}};
    motion.translation = {0.0, 0.0, gap_m};
    EXPECT_FALSE(query.separated_by(a, b, motion, gap_m * (1.0 + 0x1p-50)));
    EXPECT_TRUE(query.separated_by(a, b, motion, gap_m * 0.4 - 1e-4));
  }
}

TEST(TouchNear, FindsOnlyWhatTouches) {
  const TriangleSoup ring = torus(16, 32, true);
  WideTree a(ring), b(ring);
  WideQuery query;
  Numbers numbers(3);
  int again = 0, never = 0;
  for (int i = 0; i < 100; ++i) {
    const Pose here = random_pose(numbers, 0.8);
    Pose there = random_pose(numbers, 0.8);
    PolygonPair pair{};
    WideQuery::LeafPair leaf_pair;
    if (!query.find_pair(a, b, RelativeMotion(here, there), pair, &leaf_pair)) continue;
    for (int k = 0; k < 30; ++k) {
      there.position += Vec3(0.03, 0.01, 0.02);
      const RelativeMotion motion(here, there);
      const bool touching = query.find_pair(a, b, motion, pair);
      WideQuery::LeafPair beside = leaf_pair;
      const bool found = query.touch_near_leaves(a, b, motion, beside);
      EXPECT_LE(found, touching);
      if (found) leaf_pair = beside;
      again += found;
      never += !touching;
    }
  }
  EXPECT_GT(again, 300);
  EXPECT_GT(never, 100);
}

}  // namespace peerd::collision::pair_coherence_test
