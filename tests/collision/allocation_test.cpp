#include <gtest/gtest.h>

#include "collision/mesh_distance.hpp"
#include "collision/time_of_impact.hpp"
#include "tests/allocation_counter.hpp"
#include "tests/collision/soups.hpp"

#if PEERD_COUNTS_ALLOCATIONS
namespace peerd::collision {
namespace {

TEST(Allocation, QueriesMakeNoneOnceTheirMemoryHasGrown) {
  const TriangleSoup soup = torus(16, 32, true), other = random_soup(400, 0.1, 71);
  WideTree a(soup), b(other);
  a.build_all();
  b.build_all();
  WideQuery query;
  MeshImpactQuery impacts;
  MeshDistanceQuery distances;
  std::size_t pairs = 0;
  const auto ask = [&] {
    Numbers numbers(72);
    for (int i = 0; i < 50; ++i) {
      const Pose here = random_pose(numbers, 0.5), there = random_pose(numbers, 0.5);
      PolygonPair pair{};
      pairs += query.find_pair(a, b, RelativeMotion(here, there), pair);
      pairs += query.all_pairs(a, b, RelativeMotion(here, there)).size();
      KinematicState coming = at_rest(there);
      coming.position[0] += 4.0;
      coming.velocity = {-3, 0, 0};
      coming.angular_velocity_body = {0, 1, 2};
      pairs += distances.distance(a, b, RelativeMotion(here, coming.pose())).iterations;
      pairs += impacts.first_impact(a, at_rest(here), b, coming, 0.5).iterations;
    }
  };
  ask();
  const long before = allocations();
  ask();
  EXPECT_EQ(allocations(), before);
  EXPECT_GT(pairs, 0u);
}

}  // namespace
}  // namespace peerd::collision
#endif
