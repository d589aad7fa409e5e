#include "replication/physics/world/watched_pair.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/replication/peer/worlds.hpp"
#include "tests/replication/physics/world/all_watched.hpp"

namespace peerd::replication::watched_pair_test {

using namespace test;
using testing::ElementsAre;
using testing::IsEmpty;

TEST(PairCourse, IsTakenBackFromAnInstantOn) {
  WatchedPair pair{};
  pair.remember_course(sim(1s));
  pair.bears = true;
  pair.normals = {Vec3::UnitY()};
  pair.remember_course(sim(2s));
  pair.in_burst = 5;
  pair.remember_course(sim(2s));
  pair.in_burst = 6;
  pair.rewind_course(sim(2001ms));
  EXPECT_EQ(pair.in_burst, 6u);
  pair.rewind_course(sim(2s));
  EXPECT_EQ(pair.in_burst, 0u) << "of one instant all is taken back";
  EXPECT_TRUE(pair.bears);
  EXPECT_THAT(pair.normals, ElementsAre(Vec3(Vec3::UnitY())));
  pair.rewind_course(sim(500ms));
  EXPECT_FALSE(pair.bears);
  EXPECT_THAT(pair.normals, IsEmpty());
  EXPECT_THAT(pair.past, IsEmpty());
}

TEST(PairCourse, IsForgottenBeforeAnInstant) {
  WatchedPair pair{};
  for (std::uint32_t k = 1; k <= 5; ++k) {
    pair.remember_course(sim(k * 1s));
    pair.in_burst = k;
  }
  pair.forget_course_before(sim(3s));
  EXPECT_EQ(pair.past.size(), 3u);
  pair.rewind_course(sim(1s));
  EXPECT_EQ(pair.in_burst, 2u) << "that before the first one that is left";
}

TEST(PairCourse, KnowsWhenItWasFreeBefore) {
  WatchedPair pair{};
  for (const Duration t : {1s, 2s, 3s}) pair.note_free(sim(t));
  pair.forget_free_since(sim(2s));
  EXPECT_EQ(pair.free_at, sim(1s));
  pair.forget_free_since(sim(0s));
  EXPECT_EQ(pair.free_at, std::nullopt);
}

// CAR meets CURB with its own body and, once somebody moves it, with WHEEL; CURB meets BIRD.
class CarryOver : public testing::Test {
 protected:
  [[nodiscard]] std::vector<std::uint32_t> carry_over() {
    return replication::carry_over(*world.model, std::move(known), *next, sim(2s), is_watched, pairs);
  }

  static std::string car_and_curb() {
    return car_and_wheel() + box("CURB", "0.5 0.6 4", "8 0.5 0", kBounces) + box("BIRD", "1 1 1", "0 9 0") +
           interest("CAR", "\"CURB\"");
  }

  World world{car_and_curb() + interest("CURB", "\"BIRD\"")};
  std::unique_ptr<const WorldModel> next = extended(*world.model, std::vector{world["WHEEL"]});
  IsWatched is_watched;
  WatchedPairs known = all_watched(*world.model, sim(1s)), pairs{*next};
};

TEST_F(CarryOver, PairsAreThoseOfTheModel) {
  ASSERT_EQ(known.size(), 2u);
  ASSERT_EQ(pairs.size(), 3u);
  EXPECT_TRUE(known[0].is_plain);
  EXPECT_FALSE(known[0].is_answered());
  EXPECT_TRUE(known[1].collider_responds);
  EXPECT_FALSE(known[1].collidee_responds);
  pairs = all_watched(*next, sim(1s));
  EXPECT_FALSE(pairs[1].is_plain) << "the wheel is a part of the car";
  for (const std::uint32_t i : {0u, 1u, 2u}) EXPECT_EQ(pairs[i].clear_until, sim(1s));
}

TEST_F(CarryOver, ThePairOfTheSamePartsKeepsWhatIsKnownOfIt) {
  known[1].bears = true;
  known[1].clear_until = sim(7s);
  known[1].normals = {Vec3::UnitY()};
  EXPECT_THAT(carry_over(), ElementsAre(0, 1)) << "the car without its wheel is another body";
  EXPECT_TRUE(pairs[2].bears);
  EXPECT_EQ(pairs[2].clear_until, sim(7s));
  EXPECT_THAT(pairs[2].normals, ElementsAre(Vec3(Vec3::UnitY())));
  EXPECT_EQ(pairs[2].collider, next->index_of(world["CURB"])) << "by the numbers of the model now";
  EXPECT_EQ(pairs[2].collidee, next->index_of(world["BIRD"]));
}

TEST_F(CarryOver, OtherPartsOfAnInterestAreWatchedAndInsideAsTheWholeWas) {
  is_watched = [&](const CollisionPair& pair) { return pair.collider != world["CAR"]; };
  known[0].watched = false;
  known[0].inside = true;
  known[0].bears = true;
  EXPECT_THAT(carry_over(), ElementsAre(0, 1));
  for (const std::size_t i : {0u, 1u}) {
    EXPECT_FALSE(pairs[i].watched);
    EXPECT_TRUE(pairs[i].inside);
    EXPECT_FALSE(pairs[i].bears) << "on which of them it rests is not known";
  }
  EXPECT_TRUE(pairs[2].watched);
}

TEST_F(CarryOver, WhatWasNeverWatchedIsNot) {
  known = WatchedPairs(*world.model);
  add_pairs(known, *world.model, 1, sim(1s), false);
  is_watched = [](const CollisionPair&) { return false; };
  EXPECT_THAT(carry_over(), IsEmpty());
  EXPECT_THAT(pairs.numbers(), ElementsAre(2)) << "the car's are still not there";
  EXPECT_FALSE(pairs[2].watched);
}

TEST_F(CarryOver, PairsOfANewInterestAreWatched) {
  const World without{car_and_curb()};
  known = WatchedPairs(*without.model);
  const auto added = replication::carry_over(*without.model, std::move(known), *next, sim(2s), {}, pairs);
  EXPECT_THAT(added, ElementsAre(0, 1, 2)) << "the car was far, and has a part now that moves in it";
  EXPECT_TRUE(pairs[2].watched);
  EXPECT_EQ(pairs[2].clear_until, sim(2s));
}

TEST_F(CarryOver, TheSameModelChangesNothing) {
  next = extended(*world.model, {});
  pairs = WatchedPairs(*next);
  known[0].inside = true;
  EXPECT_THAT(carry_over(), IsEmpty());
  EXPECT_TRUE(pairs[0].inside);
}

}  // namespace peerd::replication::watched_pair_test
