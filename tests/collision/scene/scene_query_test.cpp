#include "collision/scene/scene_query.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/geometry/tessellate.hpp"
#include "tests/allocation_counter.hpp"
#include "tests/collision/scene/groups.hpp"
#include "tests/collision/soups.hpp"
#include "tests/core/read_text.hpp"
#include "tests/oracle/ray_oracle.hpp"

namespace peerd::collision::scene_query_test {

using ::testing::ElementsAreArray;
using ::testing::IsEmpty;
using ::testing::Not;

Collision ask(SceneQuery& query, const Scene& scene, std::string_view a, std::string_view b, CollisionType type) {
  const auto collision = query.collide(id(scene, a), id(scene, b), type);
  EXPECT_TRUE(collision.has_value()) << collision.error();
  return collision.value_or(Collision{});
}

// Every shape against every one, every triangle against every one, by the documented operations written out again.
std::vector<ShapePair> expected_pairs(const Scene& scene, std::string_view collider, std::string_view collidee) {
  std::vector<ShapePair> pairs;
  const auto surfaces = [&](std::string_view path) {
    std::vector<std::uint32_t> shapes;
    const ObjectId object = id(scene, path);
    for (std::uint32_t i = object.number; i < scene.at(object).subtree_end; ++i) {
      if (scene.geometry(ObjectId{i}) != nullptr && scene.at(ObjectId{i}).collides) shapes.push_back(i);
    }
    return shapes;
  };
  for (const std::uint32_t s : surfaces(collider)) {
    for (const std::uint32_t t : surfaces(collidee)) {
      if (s == t) continue;
      const std::uint32_t a = std::min(s, t), b = std::max(s, t);
      const StretchedPose at_a = placed(scene, a), at_b = placed(scene, b);
      const auto soup_a = make_soup(build_mesh(*scene.geometry(ObjectId{a})), at_a.stretch);
      const auto soup_b = make_soup(build_mesh(*scene.geometry(ObjectId{b})), at_b.stretch);
      for (const PolygonPair& pair : brute_force(*soup_a, *soup_b, RelativeMotion(at_a.pose, at_b.pose))) {
        const ShapePolygon of_a{ObjectId{a}, pair.a}, of_b{ObjectId{b}, pair.b};
        pairs.push_back(s == a ? ShapePair{of_a, of_b} : ShapePair{of_b, of_a});
      }
    }
  }
  std::ranges::sort(pairs);
  return pairs;
}

TEST(SceneQuery, GroupsCollideAsAllPairsOfTheirShapesDo) {
  const Scene scene = scene_of(std::string(kGroups));
  SceneQuery query(scene);
  const std::vector<ShapePair> expected = expected_pairs(scene, "A", "B");
  ASSERT_THAT(expected, Not(IsEmpty()));
  EXPECT_THAT(ask(query, scene, "A", "B", CollisionType::kAllPairs).pairs, ElementsAreArray(expected));
  EXPECT_THAT(ask(query, scene, "B", "A", CollisionType::kAllPairs).pairs,
              ElementsAreArray(expected_pairs(scene, "B", "A")));
  const Collision witness = ask(query, scene, "A", "B", CollisionType::kWitness);
  ASSERT_EQ(witness.pairs.size(), 1u);
  EXPECT_TRUE(std::ranges::binary_search(expected, witness.pairs[0]));
}

TEST(SceneQuery, MovingOneCostsWhatIsBelowIt) {
  const Scene scene = scene_of(R"(
    DEF A Transform { children [
      DEF B Transform { children [ Shape { geometry Box {} } Shape { geometry Cone {} } ] }
      DEF C Transform { children Shape { geometry Sphere {} } } ] }
    DEF D Transform { translation 9 0 0 children Shape { geometry Box {} } })");
  SceneQuery query(scene);
  const auto placed_for_a = [&] {
    const std::uint64_t before = query.counters().boxes_placed;
    (void)query.box(id(scene, "A"));
    (void)query.box(id(scene, "D"));
    return query.counters().boxes_placed - before;
  };
  EXPECT_EQ(placed_for_a(), 4u);
  EXPECT_EQ(placed_for_a(), 0u);
  TransformFields moved;
  moved.translation = {0, 5, 0};
  EXPECT_TRUE(query.move(scene.at(id(scene, "B")).transform, moved));
  EXPECT_EQ(placed_for_a(), 2u);
  EXPECT_GT(query.box(id(scene, "A")).hi[1], 5.9);
  EXPECT_LT(query.box(id(scene, "C")).hi[1], 1.1);
  EXPECT_FALSE(query.move(scene.at(id(scene, "B")).transform, moved));
  query.move(scene.at(id(scene, "C")).transform, moved);
  query.move(scene.at(id(scene, "A")).transform, moved);
  query.move(scene.at(id(scene, "B")).transform, TransformFields{});
  EXPECT_EQ(placed_for_a(), 3u);
  EXPECT_GT(query.box(id(scene, "C")).hi[1], 10.9);
}

// No corner of a Shape's box goes farther than the way, however it is turned and scaled, and one goes as far.
TEST(SceneQuery, WaysAreThoseOfTheFarthestCorners) {
  const Scene scene = scene_of(R"(
    DEF A Transform { children DEF B Transform { translation 1 2 3 children [
      Shape { geometry Box { size 1 2 3 } } Transform { translation 4 0 0 children DEF S Shape { geometry IndexedFaceSet {
        coord Coordinate { point [ 3 0 0, 5 1 0, 3 2 2 ] } coordIndex [ 0 1 2 ] } } } ] } })");
  SceneQuery query(scene);
  std::vector<TransformFields> transforms = scene.transforms;
  const auto corners = [&] {
    std::vector<Vec3> all;
    Scene now = scene;
    now.transforms = transforms;
    for (std::uint32_t i = 0; i < now.instances.size(); ++i) {
      if (now.geometry(ObjectId{i}) == nullptr) continue;
      const LocalBox box = box_of(build_mesh(*now.geometry(ObjectId{i})));
      for (int corner = 0; corner < 8; ++corner) {
        Vec3 p;
        for (int k = 0; k < 3; ++k) p[k] = (corner >> k & 1) == 0 ? box.lo[k] : box.hi[k];
        all.push_back(now.world_from_local(ObjectId{i}) * p);
      }
    }
    return all;
  };
  (void)query.box(id(scene, "A"));
  Numbers numbers(6);
  for (int i = 0; i < 200; ++i) {
    const std::vector<Vec3> before = corners();
    TransformFields& moved = transforms[static_cast<std::size_t>(i) % transforms.size()];
    const double size = std::exp2(numbers.between(-30, 2));
    moved.translation += numbers.point(size);
    moved.rotation = normalized(multiply(moved.rotation, quat_exp(numbers.point(size))));
    if (i % 5 == 0) moved.scale = Vec3(1, 1, 1) + numbers.point(0.3);
    query.set_transforms(transforms);
    (void)query.box(id(scene, "A"));
    const std::vector<Vec3> after = corners();
    double farthest = 0.0;
    for (std::size_t v = 0; v < after.size(); ++v) farthest = std::max(farthest, (after[v] - before[v]).norm());
    EXPECT_GE(query.displacement_m(id(scene, "A")), farthest);
    EXPECT_LE(query.displacement_m(id(scene, "A")), farthest * (1.0 + 1e-9) + 1e-9);
    EXPECT_LE(query.displacement_m(id(scene, "S")), query.displacement_m(id(scene, "B")));
  }
}

// Closed boxes, of the vertices that polygons use.
TEST(SceneQuery, BoxesAreTightAndClosed) {
  const Scene scene = scene_of(R"(
    DEF A Transform { rotation 0 0 1 0.785398163 children Shape { geometry Box {} } }
    DEF B Transform { translation 2.4 0 0 children Shape { geometry Box {} } }
    DEF C Transform { translation 2.42 0 0 children Shape { geometry Box {} } }
    DEF D Transform { translation 4.42 0 0 children Shape { geometry IndexedFaceSet {
      coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0, -9 0 0 ] } coordIndex [ 0 1 2 ] } } })");
  SceneQuery query(scene);
  EXPECT_TRUE(ask(query, scene, "A", "B", CollisionType::kBox).colliding);
  EXPECT_FALSE(ask(query, scene, "A", "C", CollisionType::kBox).colliding);
  EXPECT_FALSE(ask(query, scene, "B", "D", CollisionType::kBox).colliding);
  const SceneQueryCounters counters = query.counters();
  EXPECT_EQ(counters.hierarchies_built, 0u);
  EXPECT_EQ(counters.soups_built, 0u);
  EXPECT_EQ(counters.nodes_built, 0u);
}

TEST(SceneQuery, BuildsNothingThatNoQuestionNeeds) {
  const Scene scene = scene_of(R"(
    DEF A Transform { children Shape { geometry DEF S Sphere {} } }
    DEF B Transform { translation 9 0 0 children Shape { geometry USE S } }
    DEF C Transform { translation 1.2 0 0 children Shape { geometry USE S } }
    DEF D Transform { translation 1.2 1 0 scale 2 2 2 children Shape { geometry USE S } }
    DEF E Transform { children Shape { geometry Box {} } })");
  SceneQuery query(scene);
  EXPECT_EQ(query.counters().meshes_built, 0u);
  EXPECT_FALSE(ask(query, scene, "A", "B", CollisionType::kWitness).colliding);  // their boxes are apart
  EXPECT_EQ(query.counters().meshes_built, 1u);
  EXPECT_EQ(query.counters().soups_built, 0u);
  EXPECT_TRUE(ask(query, scene, "A", "C", CollisionType::kWitness).colliding);
  EXPECT_EQ(query.counters().soups_built, 1u);
  EXPECT_EQ(query.counters().hierarchies_built, 1u);  // of one mesh, however many instances
  const std::uint64_t nodes = query.counters().nodes_built;
  (void)ask(query, scene, "A", "D", CollisionType::kAllPairs);
  EXPECT_EQ(query.counters().soups_built, 2u);  // stretched otherwise
  EXPECT_GT(query.counters().nodes_built, nodes);
  EXPECT_EQ(query.counters().meshes_built, 1u);
}

// The thesis's box (3.2.3) holds every vertex, is larger than theirs where an object is turned, and reads none again.
TEST(SceneQuery, RealignedBoxesAreLargerAndReadNoVertexTwice) {
  const std::string ball = "Shape { geometry Sphere { radius 1 } }";
  const Scene scene = scene_of("DEF A Transform { rotation 1 1 0.3 0.7 children " + ball + "}" +
                               "DEF B Transform { rotation 0.2 1 0.5 0.4 translation 3 0 0 children " + ball + "}" +
                               "CollisionInterest { objectPath \"A\" interests \"B\" }");
  const ObjectId a = scene.find("A").value(), b = scene.find("B").value();
  SceneQuery tight(scene), loose(scene);
  loose.set_box_bound(BoxBound::kRealigned);
  int only_loose = 0;
  for (int i = 0; i < 400; ++i) {
    TransformFields moved = scene.transform(b);
    moved.translation = {1.9 + 0.001 * i, 0, 0};
    for (SceneQuery* query : {&tight, &loose}) query->move(scene.at(b).transform, moved);
    const bool by_vertices = tight.collide(a, b, CollisionType::kBox).value().colliding;
    const bool realigned = loose.collide(a, b, CollisionType::kBox).value().colliding;
    ASSERT_TRUE(realigned || !by_vertices) << i;
    only_loose += realigned && !by_vertices;
  }
  EXPECT_GT(only_loose, 20);
  EXPECT_EQ(loose.counters().vertices_placed, 0u);
  EXPECT_EQ(loose.counters().soups_built, 0u);
}

}  // namespace peerd::collision::scene_query_test
