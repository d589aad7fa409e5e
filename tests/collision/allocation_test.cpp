#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "collision/query/mesh_distance.hpp"
#include "collision/query/time_of_impact.hpp"
#include "collision/scene/collision_watch.hpp"
#include "tests/allocation_counter.hpp"
#include "tests/collision/soups.hpp"
#include "tests/core/read_text.hpp"

#if PEERD_COUNTS_ALLOCATIONS
namespace peerd::collision::allocation_test {

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

// Thirty objects go round, meet and part. Polygons aren't asked for: those are lists.
TEST(Allocation, TicksMakeNoneOnceTheirMemoryHasGrown) {
  std::string body = "DEF S Transform { children DEF BALL Shape { geometry Sphere { radius 0.4 } } }";
  for (int i = 0; i < 30; ++i) {
    body += "DEF T" + std::to_string(i) + " Transform { children USE BALL }";
    body += "CollisionInterest { objectPath \"T" + std::to_string(i) + "\" collisionType 1 interests [ \"S\"";
    for (int k = 0; k < i; ++k) body += " \"T" + std::to_string(k) + '"';
    body += " ] }";
  }
  const Scene scene = scene_of(body);
  CollisionWatch watch(scene);
  std::size_t changes = 0;
  const auto round = [&] {
    for (int tick = 0; tick < 100; ++tick) {
      for (std::uint32_t t = 0; t < scene.transforms.size(); ++t) {
        TransformFields fields;
        const double angle = 0.0628318530717958 * tick * (1 + t % 3) + t;
        fields.translation = {2 * std::cos(angle), 0.1 * (t % 7), 2 * std::sin(angle)};
        fields.rotation = quat_exp({angle, 0, 0});
        watch.move(t, fields);
      }
      const CollisionWatch::Tick& answer = watch.tick();
      changes += answer.began.size() + answer.ended.size();
    }
  };
  for (int i = 0; i < 3; ++i) round();
  const long before = allocations();
  changes = 0;
  round();
  EXPECT_EQ(allocations(), before);
  EXPECT_GT(changes, 100u);
}

}  // namespace peerd::collision::allocation_test
#endif
