#include "collision/scene/scene_pick.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "collision/scene/scene_query.hpp"
#include "core/geometry/tessellate.hpp"
#include "tests/allocation_counter.hpp"
#include "tests/collision/oracle_types.hpp"
#include "tests/collision/scene/groups.hpp"
#include "tests/collision/soups.hpp"
#include "tests/core/read_text.hpp"
#include "tests/oracle/ray_oracle.hpp"

namespace peerd::collision::scene_pick_test {

using ::testing::HasSubstr;

struct Nearest {
  double t = 0.0;
  ShapePolygon at;
  Vec3 side_u, side_v;  // of the triangle, in the world
};

// Every triangle of every Shape that is drawn, by rational numbers, after the documented operations written out again.
std::optional<Nearest> expected_pick(const Scene& scene, const Vec3& origin, const Vec3& direction, double longest) {
  std::optional<Nearest> best;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    if (scene.geometry(ObjectId{i}) == nullptr || !scene.at(ObjectId{i}).drawn) continue;
    const StretchedPose at = placed(scene, i);
    const auto soup = make_soup(build_mesh(*scene.geometry(ObjectId{i})), at.stretch);
    const Mat3 back = at.pose.orientation.toRotationMatrix().transpose();
    const Vec3 o = multiply(back, Vec3(origin - at.pose.position)), d = multiply(back, direction);
    for (std::uint32_t f = 0; f < soup->faces.size(); ++f) {
      const auto t = oracle::first_parameter(plain(o), plain(d), plain(soup->triangle(f)));
      const ShapePolygon polygon{ObjectId{i}, soup->faces[f].polygon};
      if (t && *t <= longest && (!best || std::pair(*t, polygon) < std::pair(best->t, best->at))) {
        const auto corners = soup->triangle(f);
        best = {*t, polygon, at.pose.orientation * Vec3(corners[1] - corners[0]),
                at.pose.orientation * Vec3(corners[2] - corners[0])};
      }
    }
  }
  return best;
}

std::optional<Pick> pick(SceneQuery& query, const Vec3& origin, const Vec3& direction) {
  const auto picked = query.pick(origin, direction);
  EXPECT_TRUE(picked.has_value()) << picked.error();
  return picked.value_or(std::nullopt);
}

TEST(ScenePick, IsTheNearestPolygonOfWhatIsDrawn) {
  const Scene scene = scene_of(std::string(kGroups) + R"(
    Collision { children Transform { translation 0 3 0 children Shape { geometry Box {} } }
                proxy Shape { geometry Box { size 30 30 0.1 } } }
    Switch { choice Shape { geometry Box { size 40 40 0.1 } } })");
  SceneQuery query(scene);
  Numbers numbers(301);
  int hits = 0, rays = 0;
  std::set<std::uint32_t> shapes;
  for (int i = 0; i < 60; ++i) {
    const Vec3 origin = numbers.point(i % 3 == 0 ? 1.0 : 12.0);
    const Vec3 direction = i % 4 == 3 ? numbers.point(1.0) : Vec3(numbers.point(1.5) - origin);
    const double longest = i % 5 == 4 ? 4.0 : std::numeric_limits<double>::infinity();
    const auto picked = query.pick(origin, direction, longest * direction.norm());
    const auto expected = expected_pick(scene, origin, direction, longest);
    ASSERT_TRUE(picked.has_value());
    ASSERT_EQ(picked->has_value(), expected.has_value()) << i;
    ++rays;
    if (!expected) continue;
    const Pick& found = **picked;
    EXPECT_EQ(found.at, expected->at);
    EXPECT_DOUBLE_EQ(found.distance_m, expected->t * direction.norm());
    EXPECT_LT((found.point_world - (origin + expected->t * direction)).norm(), 1e-12);
    EXPECT_NEAR(found.normal_world.norm(), 1.0, 1e-12);
    EXPECT_LT(found.normal_world.dot(direction), 0.0);
    EXPECT_NEAR(found.normal_world.dot(expected->side_u.normalized()), 0.0, 1e-9);
    EXPECT_NEAR(found.normal_world.dot(expected->side_v.normalized()), 0.0, 1e-9);
    shapes.insert(found.at.shape.number);
    ++hits;
  }
  EXPECT_GT(hits, rays / 2);
  EXPECT_LT(hits, rays);
  EXPECT_GT(shapes.size(), 4u);
}

TEST(ScenePick, TheLowerShapeIsNamedWhereTwoAreHitInOnePoint) {
  for (const bool swapped : {false, true}) {
    const std::string near = "Transform { translation 0 0 1 children Shape { geometry Box { size 2 2 2 } } }";
    const std::string same = "Transform { translation 0 0 0 children Shape { geometry Box { size 9 9 4 } } }";
    const Scene scene = scene_of(swapped ? same + near : near + same);
    SceneQuery query(scene);
    const auto picked = pick(query, Vec3(0.1, 0.2, 7), Vec3(0, 0, -1));
    ASSERT_TRUE(picked.has_value());
    EXPECT_EQ(picked->at.shape.number, 1u);
    EXPECT_EQ(picked->distance_m, 5.0);
  }
}

TEST(ScenePick, AsksAndBuildsNothingBehindTheNearestHit) {
  const Scene scene = scene_of(R"(
    DEF BEHIND Transform { translation 0 0 -20 children Shape { geometry Sphere { radius 2 } } }
    DEF ASIDE Transform { translation 20 0 0 children Shape { geometry Cone {} } }
    DEF GROUP Group { children [
      Transform { translation 0 0 -5 children Shape { geometry Cylinder {} } }
      Transform { children Shape { geometry Box {} } } ] })");
  SceneQuery query(scene);
  EXPECT_FALSE(pick(query, Vec3(0, 50, 0), Vec3(0, 1, 0)).has_value());
  EXPECT_EQ(query.counters().soups_built, 0u);
  const auto picked = pick(query, Vec3(0.1, 0.2, 30), Vec3(0, 0, -1));
  ASSERT_TRUE(picked.has_value());
  EXPECT_EQ(picked->distance_m, 29.0);
  EXPECT_EQ(query.counters().soups_built, 1u);
  EXPECT_EQ(query.counters().hierarchies_built, 1u);
  const std::uint64_t boxes = query.counters().boxes_placed;
  EXPECT_EQ(boxes, 4u);
  (void)pick(query, Vec3(0.1, 0.2, 30), Vec3(0, 0, -1));
  EXPECT_EQ(query.counters().boxes_placed, boxes);
  EXPECT_EQ(query.counters().soups_built, 1u);
}

TEST(ScenePick, RefusesWhatIsNoRayAndNamesWhatItCanNotUse) {
  const Scene scene = scene_of(R"(
    DEF A Transform { scale 1e38 1 1 children DEF FAR Shape { geometry Box { size 10 10 10 } } }
    DEF B Transform { translation 0 0 50 children Shape { geometry Box {} } })");
  SceneQuery query(scene);
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(query.pick(Vec3::Zero(), Vec3::Zero()).has_value());
  EXPECT_FALSE(query.pick(Vec3(nan, 0, 0), Vec3(0, 0, 1)).has_value());
  EXPECT_FALSE(query.pick(Vec3(0, infinity, 0), Vec3(0, 0, 1)).has_value());
  EXPECT_FALSE(query.pick(Vec3::Zero(), Vec3(0, 0, infinity)).has_value());
  EXPECT_FALSE(query.pick(Vec3::Zero(), Vec3(0, nan, 1)).has_value());
  EXPECT_FALSE(query.pick(Vec3::Zero(), Vec3(0, 0, 1), nan).has_value());
  EXPECT_FALSE(query.pick(Vec3::Zero(), Vec3(0, 0, 1), -1.0).has_value());
  const auto refused = query.pick(Vec3(0, 0, 20), Vec3(0, 0, -1));
  ASSERT_FALSE(refused.has_value());
  EXPECT_THAT(refused.error(), HasSubstr("A/FAR: vertex"));
}

}  // namespace peerd::collision::scene_pick_test
