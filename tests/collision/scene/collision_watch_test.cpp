#include "collision/scene/collision_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/collision/soups.hpp"
#include "tests/core/read_text.hpp"

namespace peerd::collision::collision_watch_test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using NotColliding = CollisionWatch::NotColliding;

template <class T>
std::vector<T> list(std::span<const T> items) {
  return {items.begin(), items.end()};
}
TransformFields at(double x, double y, double z) {
  TransformFields t;
  t.translation = {x, y, z};
  return t;
}
std::uint32_t transform_of(const Scene& scene, std::string_view path) {
  return scene.at(scene.find(path).value()).transform;
}

// A world with all changes made so far, and the answers of a fresh query about it.
class Oracle {
 public:
  explicit Oracle(const Scene& scene) : scene_(scene), transforms(scene.transforms) {}

  [[nodiscard]] SceneQuery fresh() const {
    SceneQuery query(scene_);
    query.set_transforms(transforms);
    for (const auto& [geometry, form] : forms) query.reshape(geometry, form);
    return query;
  }
  void expect(CollisionWatch& watch, const CollisionWatch::Tick& tick, bool ask_for_polygons) {
    SceneQuery query = fresh();
    std::vector<std::uint32_t> colliding, began, ended, refused;
    std::map<ObjectId, bool> objects;
    for (std::uint32_t i = 0; i < watch.interests().size(); ++i) {
      const auto& [collider, collidee, type] = watch.interests()[i];
      const auto expected = query.collide(collider, collidee, type);
      if (!expected) refused.push_back(i);
      const bool now = expected && expected->colliding;
      const bool before = std::ranges::binary_search(colliding_, i);
      if (now) colliding.push_back(i);
      if (now && !before) began.push_back(i);
      if (!now && before) ended.push_back(i);
      for (const ObjectId id : {collider, collidee}) objects[id] |= now;
      if (!ask_for_polygons || !expected) continue;
      const Collision& said = watch.collision(i);
      EXPECT_EQ(said.colliding, now);
      if (type == CollisionType::kWitness && !forms.empty() && now) {  // of a refitted hierarchy: any true one
        const auto all = query.collide(collider, collidee, CollisionType::kAllPairs);
        ASSERT_EQ(said.pairs.size(), 1u);
        EXPECT_TRUE(std::ranges::binary_search(all->pairs, said.pairs[0]));
      } else {
        EXPECT_EQ(said.pairs, expected->pairs) << "interest " << i;
      }
      pairs += said.pairs.size();
    }
    EXPECT_EQ(list(tick.colliding), colliding);
    EXPECT_EQ(list(tick.began), began);
    EXPECT_EQ(list(tick.ended), ended);
    std::vector<std::uint32_t> said_refused;
    for (const auto& r : tick.refused) said_refused.push_back(r.interest);
    EXPECT_EQ(said_refused, refused);
    std::vector<NotColliding> events;
    for (const auto& [id, now] : objects) {
      if (scene_.at(id).kind == NodeKind::kTransform && now != was_colliding_[id]) events.push_back({id, !now});
      was_colliding_[id] = now;
    }
    EXPECT_EQ(list(tick.not_colliding), events);
    changes += began.size() + ended.size();
    colliding_ = colliding;
  }

 private:
  const Scene& scene_;
  std::vector<std::uint32_t> colliding_;
  std::map<ObjectId, bool> was_colliding_;

 public:
  std::vector<TransformFields> transforms;
  std::map<std::uint32_t, Geometry> forms;
  std::size_t pairs = 0, changes = 0;
};

// Groups in groups, a USEd one, scales above and below rotations, what can't collide, and a sheet that bends.
constexpr std::string_view kWorld = R"(
  DEF A Transform { children [
    DEF BALL Shape { geometry Sphere { radius 0.8 } }
    DEF ARM Transform { translation 1 0 0 scale 1 0.5 1 children [
      DEF HAND Transform { translation 0.8 0 0 children Shape { geometry Box { size 0.6 0.6 0.6 } } } ] } ] }
  DEF B Transform { translation 2 0 0 children [ USE BALL USE ARM ] }
  DEF C Transform { translation 0 2 0 children Shape { geometry Cone { bottomRadius 0.5 } } }
  DEF D Transform { translation 0 2 2 scale 2 1 0.5 children [
    Transform { children Shape { geometry Cylinder { radius 0.4 } } }
    Collision { collide FALSE children Shape { geometry Box { size 9 9 9 } } } ] }
  DEF SHEET Transform { translation -1 0 0 children DEF CLOTH Shape { geometry IndexedFaceSet {
    coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0, 1 1 0, 2 1 0, 0 2 0 ] }
    coordIndex [ 0 1 2 -1 1 3 2 -1 1 4 3 -1 2 3 5 ] } } }
  DEF NOTHING Transform { children Group {} }
  DEF CUBE Transform { translation 0 0 -2 children Shape { geometry Box { size 1 1 1 } } }
  DEF CUBE2 Transform { translation 0 1 -2 children Shape { geometry Box { size 1 1 1 } } }
)";
constexpr std::string_view kInterests = R"(
  CollisionInterest { objectPath "A" interests [ "B" "C" "D" "SHEET" "NOTHING" "CUBE" ] collisionType 1 }
  CollisionInterest { objectPath "B" interests [ "C" "A" "D" "CLOTH" ] collisionType 2 }
  CollisionInterest { objectPath "C" interests [ "D" "A" "SHEET" ] }
  CollisionInterest { objectPath "A/ARM/HAND" interests [ "C" "BALL" "B" "CUBE" ] collisionType 1 }
  CollisionInterest { objectPath "D" interests [ "SHEET" "C" ] collisionType 2 }
  CollisionInterest { objectPath "A" interests [ "B" "A/BALL" ] collisionType 0 }
  CollisionInterest { objectPath "B" interests "A" collisionType 1 }
  CollisionInterest { objectPath "CUBE" interests "CUBE2" collisionType 0 }
  CollisionInterest { objectPath "CUBE2" interests "CUBE" collisionType 2 }
  CollisionInterest { objectPath "CUBE" interests "CUBE2" collisionType 1 }
)";
std::string whole_world() { return std::string(kWorld) + std::string(kInterests); }

class Walk {
 public:
  Walk(const Scene& scene, std::uint64_t seed, bool bends) : scene_(scene), numbers_(seed), bends_(bends) {}

  // A step changes a little of everything, as things move; now and then it does what they never do. `said` receives the
  // changes.
  template <class Said>
  void step(Oracle& oracle, const Said& said) {
    const auto below = [&](std::size_t n) {
      return static_cast<std::size_t>(numbers_.unit() * static_cast<double>(n));
    };
    if (below(8) == 0) return;  // nothing
    const bool all = below(2) == 0;
    for (std::uint32_t t = 0; t < oracle.transforms.size(); ++t) {
      if (!all && below(4) != 0) continue;
      TransformFields& fields = oracle.transforms[t];
      const std::size_t what = below(60);
      if (what == 0) {
        fields.translation = numbers_.point(2.5);
      } else if (what == 1) {
        fields.translation = (2.0 * numbers_.point(2.0)).array().round() / 2.0;  // where cubes touch
        fields.rotation = Quat::Identity();
      } else if (what == 2) {
        fields.scale = Vec3(1.0, 1.0, 1.0) + numbers_.point(0.5);
      } else if (what == 3) {
        fields.scale = scene_.transforms[t].scale;
      } else {
        fields.translation += numbers_.point(0.02) - 0.005 * fields.translation;
        fields.rotation = normalized(multiply(fields.rotation, quat_exp(numbers_.point(0.02))));
      }
      said(t, fields);
    }
    if (!bends_ || below(3) != 0) return;
    for (std::uint32_t g = 0; g < scene_.geometries.size(); ++g) {
      if (!std::holds_alternative<FaceSetGeometry>(scene_.geometries[g])) continue;
      auto faces = std::get<FaceSetGeometry>(scene_.geometries[g]);
      std::vector<Eigen::Vector3f> points(faces.points.begin(), faces.points.end());
      for (auto& p : points) p += numbers_.point(0.3).cast<float>();
      faces.points = std::move(points);
      if (below(9) == 0) faces.corners = std::vector<std::int32_t>{0, 1, 2, -1, 0, 2, 5};
      oracle.forms[g] = faces;
      said(g, Geometry(faces));
    }
  }

 private:
  const Scene& scene_;
  Numbers numbers_;
  bool bends_;
};

struct WatchUpdater {
  CollisionWatch& watch;
  void operator()(std::uint32_t t, const TransformFields& fields) const { watch.move(t, fields); }
  void operator()(std::uint32_t g, const Geometry& form) const { watch.reshape(g, form); }
};

class Walks : public testing::TestWithParam<int> {};

TEST_P(Walks, EveryTickIsWhatANewQueryAnswers) {
  const Scene scene = scene_of(whole_world());
  const bool bends = GetParam() % 2 == 1;
  Oracle oracle(scene);
  Walk walk(scene, static_cast<std::uint64_t>(GetParam()), bends);
  CollisionWatch watch(scene);
  oracle.expect(watch, watch.tick(), true);
  for (int tick = 0; tick < 1500 && !HasFailure(); ++tick) {
    SCOPED_TRACE(tick);
    walk.step(oracle, WatchUpdater{watch});
    if (tick % 3 == 0) watch.set_transforms(oracle.transforms);
    oracle.expect(watch, watch.tick(), tick % 4 != 0);
  }
  EXPECT_GT(oracle.pairs, 1000u);
  EXPECT_GT(oracle.changes, 100u);
  const CollisionWatchCounters counters = watch.counters();
  for (const std::uint64_t some :
       {counters.pairs_far, counters.pairs_unmoved, counters.pairs_separated, counters.pairs_queried,
        counters.gaps_found, counters.boxes_queried, counters.shapes.pairs_witnessed, counters.shapes.pairs_tested}) {
    EXPECT_GT(some, 10u);
  }
}
INSTANTIATE_TEST_SUITE_P(Seeds, Walks, testing::Range(1, 7));

// The same walk gives the same answers with caches and without.
TEST(CollisionWatch, AnswersDontDependOnWhatIsRemembered) {
  const Scene scene = scene_of(whole_world());
  std::vector<CollisionWatch> watches;
  for (const bool witnesses : {false, true}) {
    for (const bool gaps : {false, true}) watches.emplace_back(scene, nullptr, CoherenceOptions{witnesses, gaps});
  }
  Oracle oracle(scene);
  Walk walk(scene, 77, false);
  for (int tick = 0; tick < 600; ++tick) {
    walk.step(oracle, [&](std::uint32_t t, const auto& what) {
      for (CollisionWatch& watch : watches) WatchUpdater{watch}(t, what);
    });
    const auto expected = list(watches[0].tick().colliding);
    for (std::size_t w = 1; w < watches.size(); ++w) {
      ASSERT_EQ(list(watches[w].tick().colliding), expected) << tick;
      if (tick % 8 != 0) continue;
      for (const std::uint32_t i : expected) {
        ASSERT_EQ(watches[w].collision(i).pairs, watches[0].collision(i).pairs);
      }
    }
  }
  EXPECT_GT(2 * watches[0].counters().shapes.pairs_tested, 3 * watches[3].counters().shapes.pairs_tested);
  EXPECT_EQ(watches[0].counters().pairs_separated + watches[0].counters().shapes.pairs_witnessed, 0u);
}

// Touching counts, and what moves together far from the origin is rounded anew: skipping may not.
TEST(CollisionWatch, SlowestMotionIsSeenToTheLastBit) {
  const Scene scene = scene_of(R"(
    DEF A Transform { children Shape { geometry Box {} } }
    DEF B Transform { translation 2.5 0 0 children Shape { geometry Box {} } }
    CollisionInterest { objectPath "A" interests "B" collisionType 1 })");
  CollisionWatch watch(scene);
  const std::uint32_t b = transform_of(scene, "B");
  double x = 2.0 + 0x1p-38;
  std::size_t ticks = 0;
  for (; x >= 2.0 - 0x1p-39; x -= 0x1p-44, ++ticks) {
    watch.move(b, at(x, 0.25, 0.125));
    ASSERT_EQ(watch.tick().colliding.size(), x <= 2.0 ? 1u : 0u) << std::hexfloat << x;
  }
  EXPECT_GT(ticks, 90u);
  EXPECT_GT(watch.counters().shapes.pairs_witnessed, 10u);
}

// The tests cover a coordinate whose last bit is more than a tick's motion, and a Shape far from its own origin.
TEST(CollisionWatch, WhatIsFarOutIsAskedAsOften) {
  const Scene scene = scene_of(R"(
    DEF A Transform { translation 1000000 0 0 rotation 1 2 3 0.5 children Shape { geometry Sphere {} } }
    DEF B Transform { children Shape { geometry IndexedFaceSet {
      coord Coordinate { point [ 999999 0 0, 1000001 0 0, 1000000 0 2 ] } coordIndex [ 0 1 2 ] } } }
    CollisionInterest { objectPath "A" interests "B" collisionType 1 })");
  for (const double step : {0x1p-34, 0x1p-31, 0x1p-24, 0x1p-10}) {
    CollisionWatch watch(scene);
    Oracle oracle(scene);
    oracle.expect(watch, watch.tick(), true);
    TransformFields& a = oracle.transforms[transform_of(scene, "A")];
    // The height at which they part.
    double low = 0.9, high = 1.1;
    for (int i = 0; i < 60; ++i) {
      a.translation[1] = 0.5 * (low + high);
      SceneQuery query = oracle.fresh();
      (query.collide(*scene.find("A"), *scene.find("B"), CollisionType::kWitness)->colliding ? low : high) =
          a.translation[1];
    }
    for (int tick = -150; tick <= 150; ++tick) {
      a.translation[1] = low - tick * step;
      watch.set_transforms(oracle.transforms);
      oracle.expect(watch, watch.tick(), tick % 16 == 0);
    }
    EXPECT_GT(oracle.changes, 0u);
    // Gaps as narrow as the others' motion are lost in binary32.
    EXPECT_EQ(watch.counters().pairs_separated > 20, step == 0x1p-10);
  }
}

constexpr std::string_view kRow = R"(
  DEF A Transform { children Shape { geometry Sphere {} } }
  DEF B Transform { translation 1.9 0 0 children Shape { geometry Sphere {} } }
  DEF C Transform { translation 3.8 0 0 children Shape { geometry Sphere {} } }
  DEF D Transform { translation 5.7 0 0 children Shape { geometry Sphere {} } }
  DEF E Transform { translation 99 0 0 children Shape { geometry Sphere {} } }
  CollisionInterest { objectPath "A" interests [ "B" "E" ] collisionType 1 }
  CollisionInterest { objectPath "B" interests "C" collisionType 2 }
  CollisionInterest { objectPath "C" interests "D" collisionType 1 } )";

TEST(CollisionWatch, WhatDoesNotMoveIsNotTested) {
  const Scene scene = scene_of(std::string(kRow));
  CollisionWatch watch(scene);
  EXPECT_THAT(watch.tick().colliding, ElementsAre(0u, 2u, 3u));
  for (std::uint32_t i = 0; i < 4; ++i) (void)watch.collision(i);
  const CollisionWatchCounters first = watch.counters();
  EXPECT_EQ(first.shapes.pairs_tested, 3u);
  EXPECT_EQ(first.pairs_far, 1u);
  for (int tick = 0; tick < 5; ++tick) {
    watch.set_transforms(scene.transforms);  // where they are
    EXPECT_THAT(watch.tick().colliding, ElementsAre(0u, 2u, 3u));
    for (std::uint32_t i = 0; i < 4; ++i) EXPECT_EQ(watch.collision(i).colliding, i != 1);
  }
  CollisionWatchCounters still = watch.counters();
  EXPECT_EQ(still.pairs_unmoved, first.pairs_unmoved + 15);
  EXPECT_EQ(still.pairs_far, first.pairs_far + 5);
  EXPECT_EQ(still.pairs_queried, first.pairs_queried);
  EXPECT_EQ(still.objects_moved, first.objects_moved);
  EXPECT_EQ(still.query.boxes_placed, first.query.boxes_placed);
  EXPECT_EQ(still.query.queries.bv_tests, first.query.queries.bv_tests);
  EXPECT_EQ(still.query.queries.triangle_tests, first.query.queries.triangle_tests);
  EXPECT_EQ(still.broad.box_tests, first.broad.box_tests);
}

TEST(CollisionWatch, OneMovedObjectCostsItsOwnPairs) {
  const Scene scene = scene_of(std::string(kRow));
  CollisionWatch watch(scene);
  watch.tick();
  const CollisionWatchCounters before = watch.counters();
  watch.move(transform_of(scene, "D"), at(5.69, 0, 0));
  EXPECT_THAT(watch.tick().colliding, ElementsAre(0u, 2u, 3u));
  const CollisionWatchCounters after = watch.counters();
  EXPECT_EQ(after.objects_moved, before.objects_moved + 1);
  EXPECT_EQ(after.query.boxes_placed, before.query.boxes_placed + 1);
  EXPECT_EQ(after.pairs_queried, before.pairs_queried + 1);
  EXPECT_EQ(after.pairs_unmoved, before.pairs_unmoved + 2);
  EXPECT_EQ(after.pairs_far, before.pairs_far + 1);
  // E comes, and is gone again before the tick.
  watch.move(transform_of(scene, "E"), at(0, 0, 0));
  watch.move(transform_of(scene, "E"), at(99, 0, 0));
  watch.tick();
  EXPECT_EQ(watch.counters().pairs_queried, after.pairs_queried);
}

TEST(CollisionWatch, OnePairOfShapesIsTestedOnceATick) {
  const Scene scene = scene_of(R"(
    DEF A Transform { children DEF SA Shape { geometry Sphere {} } }
    DEF B Transform { translation 1.7 0 0 children DEF SB Shape { geometry Sphere {} } }
    CollisionInterest { objectPath "A" interests [ "B" "SB" ] collisionType 1 }
    CollisionInterest { objectPath "B" interests [ "A" "SA" ] collisionType 2 }
    CollisionInterest { objectPath "SA" interests "SB" collisionType 1 })");
  CollisionWatch watch(scene);
  EXPECT_EQ(watch.tick().colliding.size(), 5u);
  EXPECT_EQ(watch.counters().shapes.pairs_tested, 1u);
  watch.move(transform_of(scene, "B"), at(1.7, 0.001, 0));
  EXPECT_EQ(watch.tick().colliding.size(), 5u);
  const PairCoherence::Counters shapes = watch.counters().shapes;
  EXPECT_EQ(shapes.pairs_tested + shapes.pairs_witnessed, 2u);
}

TEST(CollisionWatch, OneThatIsRefusedLeavesTheOthersTheirAnswers) {
  const Scene scene = scene_of(R"(
    DEF A Transform { children Shape { geometry Box {} } }
    DEF FAR Transform { scale 1e38 1 1 children Shape { geometry Box { size 10 10 10 } } }
    DEF B Transform { translation 1 0 0 children Shape { geometry Box {} } }
    CollisionInterest { objectPath "A" interests [ "FAR" "B" ] collisionType 1 }
    CollisionInterest { objectPath "A" interests "FAR" })");
  CollisionWatch watch(scene);
  const CollisionWatch::Tick& tick = watch.tick();
  EXPECT_THAT(tick.colliding, ElementsAre(1u, 2u));
  ASSERT_EQ(tick.refused.size(), 1u);
  EXPECT_EQ(tick.refused[0].interest, 0u);
  EXPECT_THAT(tick.refused[0].why, HasSubstr("FAR/0: vertex"));
  EXPECT_FALSE(watch.collision(0).colliding);
  TransformFields mended;
  mended.translation = {0.5, 0, 0};
  watch.move(transform_of(scene, "FAR"), mended);
  EXPECT_THAT(watch.tick().colliding, ElementsAre(1u, 2u));  // wholly inside: a soup has no inside
  EXPECT_THAT(tick.refused, IsEmpty());
  TransformFields spoilt;
  spoilt.scale = {1e300, 1e300, 1e300};
  watch.move(transform_of(scene, "FAR"), spoilt);
  watch.tick();
  EXPECT_EQ(tick.refused.size(), 1u);
  watch.move(transform_of(scene, "FAR"), at(50, 0, 0));
  EXPECT_THAT(watch.tick().ended, ElementsAre(2u));
  EXPECT_THAT(tick.refused, IsEmpty());
}

}  // namespace peerd::collision::collision_watch_test
