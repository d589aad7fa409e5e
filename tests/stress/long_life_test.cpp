// An hour at 1 Hz, and nothing has drifted.
#include "tests/stress/long_life.hpp"

#include <gmock/gmock.h>

namespace peerd::stress::long_life_test {

TEST(LongLife, AnHourChangesNothing) {
  using namespace std::chrono_literals;
  const LongLife life = live_for(1h, 1, 7s);
  EXPECT_GT(life.session_s, 3590.0);
  EXPECT_EQ(life.lost, 0u);
  EXPECT_THAT(life.drops, testing::IsEmpty());
  EXPECT_LT(life.old_copies, life.updates / 5) << "repeat_updates() does not ask how old a state is";
  EXPECT_GT(life.contacts, 1150u) << "one in 3 s";
  EXPECT_GT(life.updates, 700u);
  EXPECT_LT(life.norm_error, kNormBound);
  EXPECT_LT(life.spinner_error_rad, kSpinnerBound_rad);
  EXPECT_LT(life.ball_error_m, kBallBound_m) << "one law, published once";
  EXPECT_LT(life.ball_speed_error, kBallSpeedBound);
  EXPECT_LT(life.mover_error_m, kMoverBound_m);
  EXPECT_LT(life.machine_error_m, kMachineBound_m);
  EXPECT_EQ(life.machine_differs, 0u);
  EXPECT_LT(life.clocks_apart_ns, kClocksBound_ns);
}

}  // namespace peerd::stress::long_life_test
