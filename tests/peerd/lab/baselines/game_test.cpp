#include "peerd/lab/baselines/game.hpp"

#include <gtest/gtest.h>

#include "tests/sim/run_scenario.hpp"

namespace peerd::baselines::game_test {

class GameTest : public testing::Test {
 protected:
  config::Scenario scenario_ = sim::testing_support::scenario_of(PEERD_SOURCE_DIR "/tests/sim/worlds/meeting.toml");
  std::unique_ptr<const SharedWorld> shared_ = must(share_world(scenario_.world, scenario_.reading, scenario_.runs));
  std::vector<config::PeerObjects> objects_ = must(config::resolve(scenario_.runs.front(), shared_->world.scene));

  [[nodiscard]] std::unique_ptr<Game> make() const {
    return std::make_unique<Game>(scenario_.runs.front(), *shared_, objects_);
  }
};

TEST_F(GameTest, BeginsAtTheStartAndGoesOnTickByTick) {
  const auto game = make();
  EXPECT_EQ(game->time_of(0), game->start());
  EXPECT_EQ(game->ticks(), 0);
  for (int i = 0; i < 3; ++i) game->run_tick({});
  EXPECT_EQ(game->ticks(), 3);
}

TEST_F(GameTest, OfEqualInputsAreEqual) {
  const auto one = make(), other = make();
  const ObjectId left = *shared_->world.scene.find("LEFT");
  std::size_t contacts = 0;
  for (int i = 0; i < 600; ++i) {
    one->run_tick({});
    other->run_tick({});
    ASSERT_EQ(one->state(left), other->state(left)) << "tick " << i;
    contacts += one->take_contacts().size();
  }
  EXPECT_GT(contacts, 0u) << "LEFT meets RIGHT";
}

TEST_F(GameTest, ContactsAreThoseOfThePeersWithoutLatency) {
  const auto game = make();
  for (int i = 0; i < 600; ++i) game->run_tick({});
  const auto contacts = game->take_contacts();
  ASSERT_FALSE(contacts.empty());
  const auto ideal = sim::without_latency(scenario_.runs.front());
  const auto logs = must(sim::simulate(ideal, *shared_));
  const auto decided = std::ranges::find(logs.front().contacts, std::string("decided"), &PeerLog::Contact::kind);
  ASSERT_NE(decided, logs.front().contacts.end());
  EXPECT_NEAR(to_seconds(contacts.front().contact.at - game->start()), to_seconds(decided->at - *logs.front().start),
              1e-6);
}

}  // namespace peerd::baselines::game_test
