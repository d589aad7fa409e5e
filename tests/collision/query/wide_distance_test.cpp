#include "collision/query/wide_distance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "collision/exact/triangle_distance.hpp"
#include "collision/query/mesh_distance.hpp"
#include "tests/collision/oracle_types.hpp"
#include "tests/collision/query/oriented_boxes.hpp"
#include "tests/oracle/distance_oracle.hpp"

namespace peerd::collision::wide_distance_test {

using namespace test;

// The twelve triangles of a box's surface.
std::vector<Triangle> surface(const Parallelepiped& box) {
  const auto corner = [&](int bits) {
    Vec3 p = box.center;
    for (int k = 0; k < 3; ++k)
      p += ((bits >> k & 1) != 0 ? 1.0 : -1.0) * box.half[k] * box.sides[static_cast<std::size_t>(k)];
    return p;
  };
  std::vector<Triangle> out;
  for (int k = 0; k < 3; ++k) {
    const int u = 1 << (k + 1) % 3, v = 1 << (k + 2) % 3;
    for (const int side : {0, 1 << k}) {
      out.push_back({corner(side), corner(side | u), corner(side | u | v)});
      out.push_back({corner(side), corner(side | u | v), corner(side | v)});
    }
  }
  return out;
}
// The square of the distance of two surfaces in rational numbers. Pairs of triangles that are surely farther apart than
// the nearest are left out.
mpq_class exact_squared_distance(const Parallelepiped& a, const Parallelepiped& b) {
  const std::vector<Triangle> of_a = surface(a), of_b = surface(b);
  double nearest = std::numeric_limits<double>::infinity();
  for (const Triangle& t : of_a) {
    for (const Triangle& u : of_b) nearest = std::min(nearest, triangle_distance(t, u).upper);
  }
  mpq_class least = -1;
  for (const Triangle& t : of_a) {
    for (const Triangle& u : of_b) {
      if (triangle_distance(t, u).lower > nearest) continue;
      const mpq_class square = oracle::squared_distance(plain(t), plain(u));
      if (least < 0 || square < least) least = square;
    }
  }
  return least;
}

// The terms of a bound of the distance: along A's axes, along B's, and along the line of centers, in binary64.
std::array<double, 3> bounds_of(const Parallelepiped& a, const Parallelepiped& b) {
  const auto along = [&](const std::array<Vec3, 3>& axes) {
    Vec3 gaps;
    for (int k = 0; k < 3; ++k) gaps[k] = std::max(0.0, gap_along(a, b, axes[static_cast<std::size_t>(k)]));
    return gaps.norm();
  };
  return {along(a.sides), along(b.sides), std::max(0.0, gap_along(a, b, (b.center - a.center).normalized()))};
}

// Bounds of oriented boxes of all shapes, near and far, are never above their exact distance, and as high as each of
// the three terms: by itself, each is the only one that is as high for some.
TEST(WideDistance, BoundsOfOrientedBoxesAreTrueAndTight) {
  Numbers numbers(335);
  std::size_t overlapping = 0;
  std::array<std::size_t, 3> highest{};
  for (int i = 0; i < 300; ++i) {
    const double apart = i % 10 == 0 ? std::exp2(numbers.between(8.0, 17.0)) : numbers.between(0.0, 6.0);
    const BoxPair pair(numbers, RelativeMotion(random_pose(numbers, 0.5), random_pose(numbers, apart)), i);
    Distances distances;
    distances_of_nodes(pair.a, WideTree::kWidth, pair.b, WideTree::kWidth, pair.motion, 1e30F, distances);
    const double slack = static_cast<double>(pair.motion.slack_oriented);
    for (std::size_t row = 0; row < WideTree::kWidth; ++row) {
      for (std::size_t lane = 0; lane < WideTree::kWidth; ++lane) {
        const Parallelepiped a = exactly(pair.boxes_a[lane]), b = pair.a_from_b * exactly(pair.boxes_b[row]);
        const auto lower = static_cast<double>(distances.lower[row][lane]);
        if (separation(a, b) < 0.0) {
          ASSERT_EQ(lower, 0.0);
          ++overlapping;
          continue;
        }
        const std::array<double, 3> terms = bounds_of(a, b);
        const auto best = static_cast<std::size_t>(std::ranges::max_element(terms) - terms.begin());
        const double sure = 4.0 * slack + 1e-5 * terms[best];
        ASSERT_GE(lower, terms[best] - sure) << i << " by term " << best;
        highest[best] += terms[best] - 2.0 * sure > std::max(terms[(best + 1) % 3], terms[(best + 2) % 3]);
        if ((row + lane + static_cast<std::size_t>(i)) % 32 == 0) {
          ASSERT_LE(mpq_class(lower) * mpq_class(lower), exact_squared_distance(a, b)) << i;
        }
      }
    }
  }
  EXPECT_GT(overlapping, 100u);
  for (const std::size_t pairs : highest) EXPECT_GT(pairs, 100u);
}

// Plates that stand aslant, one above the other: axis-aligned boxes of their parts overlap, flat ones have the
// distance.
TEST(WideDistance, PlatesAboveEachOtherTakeFewPairs) {
  const TriangleSoup plate = aslant_plate(32);
  WideTree a(plate), b(plate);
  const Vec3 above = 0.01 * plate_normal();
  MeshDistanceQuery query;
  const MeshDistance found =
      query.distance(a, b, RelativeMotion(Pose{}, Pose{above, Quat::Identity()}), {.relative_accuracy = 0.1});
  EXPECT_NEAR(found.upper_m, 0.01, 0.001);
  EXPECT_LE(found.iterations, 8u);
}

}  // namespace peerd::collision::wide_distance_test
