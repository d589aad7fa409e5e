#include "collision/scene/scene_view.hpp"

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
#include "tests/collision/scene/groups.hpp"
#include "tests/collision/soups.hpp"
#include "tests/core/read_text.hpp"

namespace peerd::collision::scene_view_test {

TEST(SceneView, LeavesOutNoShapeThatIsInView) {
  std::string body;
  Numbers numbers(302);
  for (int i = 0; i < 40; ++i) {
    const Vec3 p = numbers.point(10.0);
    const std::string at = std::to_string(p[0]) + ' ' + std::to_string(p[1]) + ' ' + std::to_string(p[2]);
    body += "Transform { rotation 1 2 3 " + std::to_string(i) + " translation " + at + " children [ Shape { geometry " +
            (i % 3 == 0   ? "Box {}"
             : i % 3 == 1 ? "Cone {}"
                          : "Sphere {}") +
            " } Transform { translation 0 2 0 scale 1 0.5 2 children Shape { geometry Cylinder {} } } ] }\n";
  }
  const Scene scene = scene_of(body);
  std::size_t seen = 0, hidden = 0, wholly = 0, refined = 0;
  for (int i = 0; i < 40; ++i) {
    const auto frustum = make_frustum({random_pose(numbers, 8.0), numbers.between(0.3, 2.5), 1.5, 0.1, 20.0}).value();
    SceneQuery query(scene);
    const auto listed = query.in_view(frustum);
    ASSERT_TRUE(listed.has_value());
    EXPECT_EQ(query.counters().soups_built, 0u);
    const std::vector<ShapeInView> by_boxes(listed->begin(), listed->end());
    EXPECT_TRUE(std::ranges::is_sorted(by_boxes));
    const auto listed_by_nodes = query.in_view(frustum, 3);
    ASSERT_TRUE(listed_by_nodes.has_value());
    const std::vector<ShapeInView> by_nodes(listed_by_nodes->begin(), listed_by_nodes->end());
    EXPECT_TRUE(std::ranges::includes(by_boxes, by_nodes));
    for (std::uint32_t s = 0; s < scene.instances.size(); ++s) {
      if (scene.geometry(ObjectId{s}) == nullptr) continue;
      const StretchedPose at = placed(scene, s);
      bool some = false, all = true;
      for (const Eigen::Vector3f& v : build_mesh(*scene.geometry(ObjectId{s})).vertices) {
        const Vec3 p = at.pose * Vec3(at.stretch * v.cast<double>());
        bool in = true;
        for (std::size_t n = 0; n < frustum.count(); ++n) {
          in &= frustum[n].normal.dot(p) + frustum[n].offset_m > 1e-9;
        }
        some |= in;
        all &= in;
      }
      const auto listed_as = [&](const auto& list) {
        return std::ranges::find(list, ObjectId{s}, &ShapeInView::shape);
      };
      const bool listed_here = listed_as(by_boxes) != by_boxes.end();
      if (some) {
        EXPECT_TRUE(listed_here);
        EXPECT_NE(listed_as(by_nodes), by_nodes.end());
        EXPECT_TRUE(query.may_be_in_view(ObjectId{s}, frustum).value());
      }
      if (listed_here && listed_as(by_boxes)->wholly) {
        EXPECT_TRUE(all);
        ++wholly;
      }
      ++(listed_here ? seen : hidden);
    }
    refined += by_boxes.size() - by_nodes.size();
  }
  EXPECT_GT(seen, 100u);
  EXPECT_GT(hidden, 1000u);
  EXPECT_GT(wholly, 20u);
  EXPECT_GT(refined, 10u);
}

TEST(SceneView, SaysOfAnObjectThatNoPolygonOfItIsSeen) {
  const Scene scene = scene_of(R"(
    DEF A Transform { translation 0 0 -10 children [
      DEF LEFT Transform { translation -3 0 0 children Shape { geometry Sphere {} } }
      DEF RIGHT Transform { translation 3 0 0 children Shape { geometry Sphere {} } } ] }
    DEF PROXY Collision { proxy Transform { translation 0 0 -10 children Shape { geometry Box {} } } })");
  SceneQuery query(scene);
  const Frustum ahead = make_frustum({Pose{}, 0.2}).value();  // 1 m to each side there
  EXPECT_FALSE(query.may_be_in_view(id(scene, "A"), ahead).value());
  EXPECT_FALSE(query.may_be_in_view(id(scene, "PROXY"), ahead).value());
  const Frustum wide = make_frustum({Pose{}, 0.5}).value();
  EXPECT_TRUE(query.may_be_in_view(id(scene, "A"), wide).value());
  EXPECT_TRUE(query.may_be_in_view(id(scene, "RIGHT"), wide).value());
}

// Its corners are on both sides of the frustum's border, but there is no polygon between them.
TEST(SceneView, NothingIsSeenOfAShapeWithoutAPolygon) {
  const Scene scene = scene_of(R"(
    DEF POINTS Shape { geometry IndexedFaceSet { coord Coordinate { point [-50 0 0, 50 0 0, 0 1 0] } } })");
  SceneQuery query(scene);
  const auto frustum = make_frustum({Pose{Vec3(0, 0, 10), Quat::Identity()}, 0.8, 1.5, 0.1, 20.0}).value();
  EXPECT_FALSE(query.may_be_in_view(id(scene, "POINTS"), frustum).value());
  EXPECT_TRUE(query.in_view(frustum, 3).value().empty());
}

#if PEERD_COUNTS_ALLOCATIONS
TEST(SceneView, PickingAndLookingAllocateNothingOnceAllIsBuilt) {
  const Scene scene = scene_of(std::string(kGroups));
  SceneQuery query(scene);
  std::size_t hits = 0, seen = 0;
  const auto ask = [&] {
    Numbers numbers(303);
    for (int i = 0; i < 40; ++i) {
      const Vec3 origin = numbers.point(10.0);
      hits += query.pick(origin, Vec3(numbers.point(1.5) - origin)).value().has_value();
      const auto frustum = make_frustum({random_pose(numbers, 5.0), 0.6}).value();
      seen += query.in_view(frustum, 2).value().size();
    }
  };
  ask();
  const long before = allocations();
  ask();
  EXPECT_EQ(allocations(), before);
  EXPECT_GT(hits, 20u);
  EXPECT_GT(seen, 20u);
}
#endif

}  // namespace peerd::collision::scene_view_test
