#include "collision/engines/engine_watch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "tests/core/read_text.hpp"

namespace peerd::collision::engines::engine_watch_test {

const std::string kClocks = R"(
WorldInfo { worldTimes TRUE }
DEF T TimeSensor { cycleInterval 3 loop TRUE startTime 0 }
DEF S TimeSensor { cycleInterval 0.7 startTime 2 }
DEF P PositionInterpolator { key [ 0 0.3 0.6 1 ] keyValue [ -6 0 0, 5 1 0, 0 6 2, -6 0 1 ] }
DEF O OrientationInterpolator { key [ 0 0.5 1 ] keyValue [ 0 0 1 0, 0.3 1 0 3, 0 0 1 0 ] }
DEF G PositionInterpolator { key [ 0 0.5 1 ] keyValue [ 1 1 1, 2 3 1, 1 1 1 ] }
DEF I CoordinateInterpolator { key [ 0 0.5 1 ] keyValue [ 0 0 0, 1 0 0, 0 1 0,  0 -4 2, 5 0 0, 0 1 3,  0 0 0, 1 0 0, 0 1 0 ] }
ROUTE T.fraction_changed TO P.set_fraction
ROUTE T.fraction_changed TO O.set_fraction
ROUTE S.fraction_changed TO G.set_fraction
ROUTE T.fraction_changed TO I.set_fraction
)";
const std::string kBox = " children Shape { geometry Box { } } ";

// Objects that slide, jump back at the end of a cycle, fly off, turn about a center beside them, are carried by what
// turns, grow for a while, and bend; one is two of them.
const std::string kThings = kClocks + "DEF SLIDE Transform {" + kBox +
                            "} ROUTE P.value_changed TO SLIDE.set_translation "
                            "DEF FLY Transform { translation 9 0 0 velocityVector -1.5 0.2 0" +
                            kBox +
                            "} "
                            "DEF TURN Transform { translation 3 3 0 center 0 2 0" +
                            kBox +
                            "} ROUTE O.value_changed TO TURN.set_rotation "
                            "DEF CAROUSEL Transform { scale 1 1.5 1 children DEF RIDER Transform { translation 5 0 0" +
                            kBox +
                            "} } ROUTE O.value_changed TO CAROUSEL.set_rotation "
                            "DEF GROW Transform { translation 0 -4 0" +
                            kBox +
                            "} ROUTE G.value_changed TO GROW.set_scale "
                            "DEF BEND Transform { translation -3 2 0 children Shape { geometry IndexedFaceSet { "
                            "coord DEF C Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] } coordIndex [ 0 1 2 -1 ] } } } "
                            "ROUTE I.value_changed TO C.set_point "
                            "DEF REST Transform { translation 2 0 0" +
                            kBox +
                            "} "
                            "DEF FAR Transform { translation 0 0 90" +
                            kBox +
                            "} "
                            "DEF BOTH Transform { children [ DEF LEFT Transform { translation -7 0 0" +
                            kBox + "} DEF RIGHT Transform { translation 7 1 0 velocityVector 0 -0.3 0" + kBox +
                            "} ] } ";

std::string all_interests() {
  const std::vector<std::string> names{"SLIDE", "FLY", "TURN", "CAROUSEL", "GROW", "BEND", "REST", "FAR", "BOTH"};
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (std::size_t j = i + 1; j < names.size(); ++j) {
      out += "CollisionInterest { objectPath \"" + names[i] + "\" interests \"" + names[j] + "\" collisionType " +
             std::to_string((i + j) % 3) + " } ";
    }
  }
  return out;
}

// The same is said at each tick, from before the world began, whatever is passed over.
TEST(EngineWatch, SpaceTimeBoundsPassOverNothingThatSpheresTouch) {
  const Scene scene = scene_of(kThings + all_interests());
  for (const double hz : {17.0, 240.0}) {
    const Engine bounded = make_engine("sphere").value(), plain = make_engine("sphere,bounds=none").value();
    EXPECT_TRUE(bounded.has_space_time_bounds);
    EXPECT_FALSE(plain.has_space_time_bounds);
    EngineWatch of_bounded(scene, bounded, {}, BoxBound::kVertices), of_plain(scene, plain, {}, BoxBound::kVertices);
    std::size_t began = 0, ended = 0;
    for (int tick = 0; tick < static_cast<int>(10.0 * hz); ++tick) {
      const double time_s = -1.0 + tick / hz;
      const auto &said = of_bounded.tick(time_s), &right = of_plain.tick(time_s);
      ASSERT_TRUE(std::ranges::equal(said.began, right.began)) << time_s;
      ASSERT_TRUE(std::ranges::equal(said.ended, right.ended)) << time_s;
      began += said.began.size();
      ended += said.ended.size();
    }
    EXPECT_GT(began, 30u);
    EXPECT_GT(ended, 25u);
    const auto counters = of_bounded.watch().counters(), plain_counters = of_plain.watch().counters();
    EXPECT_EQ(plain_counters.pairs_postponed, 0u);
    EXPECT_EQ(counters.pairs_queried, plain_counters.pairs_queried);
    EXPECT_EQ(counters.pairs_postponed + counters.pairs_far, plain_counters.pairs_far);
    EXPECT_GT(counters.pairs_postponed, plain_counters.pairs_far / 3) << hz;
  }
}

// Each object is where its bound allows: its box at a later time is within its box moved by the velocity and grown by
// the rest.
TEST(MotionBounds, HoldUntilTheyEnd) {
  const Scene scene = scene_of(kThings);
  MotionBounds bounds(scene);
  std::vector<ObjectId> objects;
  for (const char* name : {"SLIDE", "FLY", "TURN", "CAROUSEL", "RIDER", "GROW", "REST", "BOTH"}) {
    objects.push_back(scene.find(name == std::string("RIDER") ? "CAROUSEL/RIDER" : name).value());
  }
  bounds.set_objects(objects);
  SceneMotion motion(scene);
  const auto boxes_at = [&](double t_s) {
    SceneQuery query(scene);
    query.set_transforms(motion.transforms_at(t_s));
    std::vector<WorldBox> boxes;
    for (const ObjectId id : objects) boxes.push_back(query.box(id));
    return boxes;
  };
  std::size_t checked = 0;
  std::vector<double> closest(objects.size(), 1e9);
  for (double t = -0.5; t < 7.0; t += 0.0625) {
    bounds.set_time(t);
    const auto now = boxes_at(t);
    for (const double h : {0.01, 0.05, 0.2, 0.7, 2.0}) {
      const auto then = boxes_at(t + h);
      for (BroadIndex i = 0; i < objects.size(); ++i) {
        const SpaceTimeBound b = bounds.bound(i);
        if (t + h >= b.end_s) continue;
        const double off = b.spread_m_s * h + 0.5 * b.acceleration_m_s2 * h * h + 1e-9;
        const WorldBox most{now[i].lo + h * b.velocity_m_s - Vec3::Constant(off),
                            now[i].hi + h * b.velocity_m_s + Vec3::Constant(off)};
        ASSERT_TRUE(most.contains(then[i])) << "object " << i << " from " << t << " by " << h;
        closest[i] = std::min(closest[i], off);
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 1500u);
  EXPECT_LT(closest[1], 1e-8) << "what flies straight on is known";
  bounds.set_time(8.0);
  EXPECT_EQ(bounds.bound(6).end_s, std::numeric_limits<double>::infinity()) << "REST";
}

TEST(MotionBounds, AreNoneForWhatBends) {
  const Scene scene = scene_of(kThings);
  MotionBounds bounds(scene);
  bounds.set_objects(std::vector<ObjectId>{scene.find("BEND").value()});
  bounds.set_time(1.0);
  EXPECT_LT(bounds.bound(0).end_s, 1.0);
}

}  // namespace peerd::collision::engines::engine_watch_test
