#include "peerd/lab/baselines/rewinding.hpp"

#include <gtest/gtest.h>

#include "peerd/peer/node/peer_node.hpp"
#include "tests/must.hpp"
#include "tests/sim/run_scenario.hpp"

namespace peerd::baselines::rewinding_test {

// LEFT moves to the right; RIGHT was there at first, and has gone far away since.
class RewindingTest : public testing::Test {
 protected:
  RewindingTest() {
    for (int ms = 0; ms <= 2000; ms += 50) {
      const SimTime t{std::chrono::milliseconds(ms)};
      rewinding_.note(right_, t, {Vec3(ms < 1000 ? 3.0 : 100.0, 0, 0), Quat::Identity()});
      rewinding_.note(left_, t, {Vec3::Zero(), Quat::Identity()});
    }
  }
  std::size_t hits(SimTime seen) {
    KinematicState state;
    state.velocity = Vec3(10, 0, 0);
    return rewinding_.contacts(left_, state, SimTime{std::chrono::seconds(2)}, 0.5, seen).size();
  }

  const std::unique_ptr<const SharedWorld> shared_ =
      must(share_world(PEERD_SOURCE_DIR "/tests/sim/worlds/meeting.wrl"));
  const ObjectId left_ = *shared_->world.scene.find("LEFT"), right_ = *shared_->world.scene.find("RIGHT");
  Rewinding rewinding_{*shared_->model};
};

TEST_F(RewindingTest, APlayerHitsWhatItSawThoughThatHasLeft) {
  EXPECT_EQ(hits(SimTime{std::chrono::milliseconds(0)}), 1u);
}

TEST_F(RewindingTest, WhoSeesThePresentMissesWhatHasLeft) {
  EXPECT_EQ(hits(SimTime{std::chrono::milliseconds(1500)}), 0u);
}

TEST_F(RewindingTest, OneTouchIsOneContact) {
  EXPECT_EQ(hits(SimTime{}), 1u);
  KinematicState inside;
  inside.position = Vec3(2.9, 0, 0);
  EXPECT_TRUE(rewinding_.contacts(left_, inside, SimTime{}, 0.01, SimTime{}).empty());
}

TEST_F(RewindingTest, TheOtherPlayersViewOfAMeetingDoesNotCount) {
  EXPECT_EQ(hits(SimTime{}), 1u);
  const KinematicState comes{.position = Vec3(3, 0, 0), .velocity = Vec3(-10, 0, 0)};
  EXPECT_TRUE(rewinding_.contacts(right_, comes, SimTime{}, 0.5, SimTime{}).empty());
}

TEST_F(RewindingTest, TheTimeIsThatOfThePlayer) {
  KinematicState state;
  state.velocity = Vec3(10, 0, 0);
  const auto found = only(rewinding_.contacts(left_, state, SimTime{std::chrono::seconds(2)}, 0.5, SimTime{}));
  EXPECT_GT(found.at, SimTime{std::chrono::seconds(2)});
  EXPECT_LT(found.at, SimTime{std::chrono::milliseconds(2400)});
}

}  // namespace peerd::baselines::rewinding_test
