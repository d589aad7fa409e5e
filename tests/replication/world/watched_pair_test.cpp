#include "replication/world/watched_pair.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/replication/worlds.hpp"

namespace peerd::replication::watched_pair_test {

using namespace test;
using testing::ElementsAre;
using testing::IsEmpty;

// CAR meets CURB with its own body and, once somebody moves it, with WHEEL; CURB meets BIRD.
class CarryOver : public testing::Test {
 protected:
  [[nodiscard]] std::vector<std::uint32_t> carry_over() {
    return replication::carry_over(*world.model, known, *next, pairs);
  }

  World world{box_with("CAR", "4 1 2", "0 2 0", "", box("WHEEL", "1 1 0.4", "1 -1 0")) +
              box("CURB", "0.5 0.6 4", "8 0.5 0", kBounces) + box("BIRD", "1 1 1", "0 9 0") +
              interest("CAR", "\"CURB\"") + interest("CURB", "\"BIRD\"")};
  std::unique_ptr<const WorldModel> next = extended(*world.model, std::vector{world["WHEEL"]});
  std::vector<WatchedPair> known = pairs_to_watch(*world.model, sim(1s)), pairs = pairs_to_watch(*next, sim(1s));
};

TEST_F(CarryOver, PairsAreThoseOfTheModel) {
  ASSERT_EQ(known.size(), 2u);
  ASSERT_EQ(pairs.size(), 3u);
  EXPECT_TRUE(known[0].is_plain);
  EXPECT_FALSE(known[0].is_answered());
  EXPECT_TRUE(known[1].collider_responds);
  EXPECT_FALSE(known[1].collidee_responds);
  EXPECT_FALSE(pairs[1].is_plain) << "the wheel is a part of the car";
  for (const WatchedPair& pair : pairs) EXPECT_EQ(pair.clear_until, sim(1s));
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

TEST_F(CarryOver, TheSameModelChangesNothing) {
  next = extended(*world.model, {});
  pairs = pairs_to_watch(*next, sim(1s));
  known[0].inside = true;
  EXPECT_THAT(carry_over(), IsEmpty());
  EXPECT_TRUE(pairs[0].inside);
}

}  // namespace peerd::replication::watched_pair_test
