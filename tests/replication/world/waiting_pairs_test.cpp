#include "replication/world/waiting_pairs.hpp"

#include <gtest/gtest.h>

#include <variant>
#include <vector>

#include "replication/world/motion_world.hpp"
#include "tests/replication/worlds.hpp"

namespace peerd::replication::waiting_pairs_test {

using namespace test;

void watch_all(MotionWorld& world, const World& w) {
  for (std::uint32_t number = 0; number < w.model->pairs.size(); ++number) world.watch(number, true);
}

std::vector<ObjectId> take_met(MotionWorld& world) {
  std::vector<ObjectId> met;
  while (const auto event = world.poll_event()) {
    if (const auto* c = std::get_if<ContactEvent>(&*event)) met.push_back(c->collidee);
  }
  return met;
}

class WaitingPair : public testing::Test {
 protected:
  World w{box("A", "1 1 1", "0 0 0", kBounces) + box("B", "1 1 1", "10 0 0") + interest("A", "\"B\"")};
  MotionWorld world{*w.model, sim(0s), MotionWorld::Watched::kNone};
};

TEST_F(WaitingPair, IsNotThereUntilOneOfTheTwoMoves) {
  world.watch(0, true);
  world.declare(w["A"], Role::kPredicted);
  world.advance(sim(1s));
  EXPECT_TRUE(world.known_pairs().empty());
  EXPECT_TRUE(world.objects().empty()) << "nobody has asked for them either";
  world.set_base(w["A"], sim(1s), moving({0, 0, 0}, {3, 0, 0}));
  EXPECT_EQ(world.known_pairs().size(), 1u);
  world.advance(sim(3s));
  EXPECT_TRUE(take_met(world).empty());
  world.advance(sim(5s));
  EXPECT_EQ(take_met(world), std::vector{w["B"]});
  EXPECT_LT(world.at(w["A"], sim(5s)).velocity.x(), 0.0);
}

TEST_F(WaitingPair, IsWatchedWhicheverOfTheTwoMoves) {
  world.watch(0, true);
  world.declare(w["A"], Role::kPredicted);
  world.set_base(w["B"], sim(0s), moving({10, 0, 0}, {-3, 0, 0}));
  world.advance(sim(5s));
  EXPECT_EQ(take_met(world), std::vector{w["B"]});
}

// A peer sets its own objects at rest where they are as it enters the session.
TEST_F(WaitingPair, IsNamedWhereTheFirstWayOfOneOfTheTwoBeginsInTheOther) {
  world.watch(0, true);
  world.declare(w["A"], Role::kAuthoritative);
  world.set_base(w["A"], sim(0s), moving({0, 0, 0}));
  world.advance(sim(1s));
  world.set_base(w["A"], sim(1s), moving({9.5, 0, 0}, {1, 0, 0}));
  world.advance(sim(2s));
  std::size_t named = 0;
  while (const auto event = world.poll_event()) named += std::holds_alternative<BodiesOverlap>(*event) ? 1 : 0;
  EXPECT_EQ(named, 1u);
}

TEST_F(WaitingPair, MeetsNothingOnceItIsNotWatched) {
  world.watch(0, true);
  world.watch(0, false);
  world.set_base(w["A"], sim(0s), moving({0, 0, 0}, {3, 0, 0}));
  world.advance(sim(5s));
  EXPECT_TRUE(world.known_pairs().empty());
  EXPECT_TRUE(take_met(world).empty());
}

TEST_F(WaitingPair, CountsAsSkippedAsOneThatIsFar) {
  MotionWorld all(*w.model, sim(0s));
  all.advance(sim(1s));
  world.watch(0, true);
  world.advance(sim(1s));
  const std::uint64_t all_before = all.counters().searches_skipped, before = world.counters().searches_skipped;
  all.advance(sim(2s));
  world.advance(sim(2s));
  EXPECT_EQ(all.counters().searches_skipped - all_before, 1u);
  EXPECT_EQ(world.counters().searches_skipped - before, 1u);
}

TEST_F(WaitingPair, WaitsOnBeyondAChangeOfTheModel) {
  world.watch(0, true);
  world.advance(sim(1s));
  const auto next = extended(*w.model, {});
  world.change_model(*next);
  EXPECT_TRUE(world.known_pairs().empty());
  EXPECT_TRUE(world.objects().empty());
  world.declare(w["A"], Role::kPredicted);
  world.set_base(w["A"], sim(1s), moving({0, 0, 0}, {3, 0, 0}));
  world.advance(sim(5s));
  EXPECT_EQ(take_met(world), std::vector{w["B"]});
}

// A law from the instant at which the world began on takes the place of the first one.
TEST(WaitingPairs, AreNoneOfWhatHasHadAnotherLawFromTheBeginOn) {
  const World w(box("A", "1 1 1", "0 0 0") + box("B", "1 1 1", "9 0 0") + interest("A", "\"B\""));
  for (const MotionModel& law : {MotionModel(moving({0, 0, 0}, {1, 0, 0})), MotionModel(moving({0, 0, 0}))}) {
    MovingObjects objects(*w.model, sim(0s));
    const WaitingPairs waiting(*w.model);
    ASSERT_TRUE(waiting.may_wait(0, objects));
    objects[objects.index_of(w["A"])].timeline.replace_from(sim(0s), law, w["B"]);
    EXPECT_FALSE(waiting.may_wait(0, objects));
  }
}

// What overlaps in the file, or whose boxes may, or who has moved already, does not wait.
TEST(WaitingPairs, AreNoneThatMayTouchInTheFileOrHaveMoved) {
  const World near(box("A", "1 1 1", "0 0 0") + box("B", "1 1 1", "2 0 0") + interest("A", "\"B\""));
  MotionWorld touching(*near.model, sim(0s), MotionWorld::Watched::kNone);
  watch_all(touching, near);
  EXPECT_EQ(touching.known_pairs().size(), 1u) << "their boxes may touch, however they turn";
  const World far(box("A", "1 1 1", "0 0 0") + box("B", "1 1 1", "9 0 0") + interest("A", "\"B\""));
  MotionWorld moved(*far.model, sim(0s), MotionWorld::Watched::kNone);
  moved.set_base(far["A"], sim(0s), moving({0, 0, 0}, {1, 0, 0}));
  watch_all(moved, far);
  EXPECT_EQ(moved.known_pairs().size(), 1u);
}

}  // namespace peerd::replication::waiting_pairs_test
