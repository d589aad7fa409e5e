#include "replication/physics/world/contact_answer.hpp"

#include <gtest/gtest.h>

#include "replication/physics/world/moving_objects.hpp"
#include "replication/physics/world/watched_pair.hpp"
#include "tests/replication/peer/worlds.hpp"
#include "tests/replication/physics/world/all_watched.hpp"

namespace peerd::replication::contact_answer_test {

using namespace test;

// Two that touch at x = 0 and have been answered: they go on as before.
class Closing : public testing::Test {
 protected:
  [[nodiscard]] ContactAnswer answered(const KinematicState& a, const KinematicState& b) const {
    ContactAnswer answer{ContactAuthority::kAsPublished, {}, {}, {}, {}, true, true};
    answer.before_a.state = answer.after_a.state = a;
    answer.before_b.state = answer.after_b.state = b;
    return answer;
  }
  [[nodiscard]] ContactAnswer closing(const ContactAnswer& answer) const {
    return answer_to_closing(*world.model, objects, pairs[0], answer);
  }
  static KinematicState spinning(const Vec3& p, const Vec3& spin_rad_s) {
    KinematicState s = moving(p);
    s.angular_velocity_body = spin_rad_s;
    return s;
  }
  static Vec3 spin(const MotionModel& law) { return law.state.angular_velocity_body; }

  World world{box("A", "1 1 1", "-0.5 0 0", kBounces) + box("B", "1 1 1", "0.5 0 0", kBounces) +
              interest("A", "\"B\"") + interest("B", "\"A\"")};
  MovingObjects objects{*world.model, sim(0s)};
  WatchedPairs pairs = all_watched(*world.model, sim(0s));
};

TEST_F(Closing, WhatTurnsStopsItsSpinWhicheverItIs) {
  const Vec3 none = Vec3::Zero(), spins(0, 0, 3);
  for (const auto& [of_a, of_b] : {std::pair(spins, none), std::pair(none, spins), std::pair(spins, spins)}) {
    // Their centres approach, so without a spin they would go back.
    ContactAnswer answer = answered(spinning({-0.5, 0, 0}, of_a), spinning({0.5, 0, 0}, of_b));
    answer.before_a.state.velocity = answer.after_a.state.velocity = {-1, 0, 0};
    pairs[0].normal = -Vec3::UnitX();
    const ContactAnswer after = closing(answer);
    EXPECT_TRUE(spin(after.after_a).isZero(0.0));
    EXPECT_TRUE(spin(after.after_b).isZero(0.0));
    EXPECT_EQ(after.after_a.state.velocity, Vec3(-1, 0, 0)) << "which alone is answered";
    EXPECT_EQ(after.after_b.state.velocity, none);
  }
}

TEST_F(Closing, WhatDoesNotAnswerKeepsItsSpin) {
  ContactAnswer answer = answered(spinning({-0.5, 0, 0}, {0, 0, 3}), spinning({0.5, 0, 0}, {0, 3, 0}));
  answer.a_responds = false;
  const ContactAnswer after = closing(answer);
  EXPECT_EQ(spin(after.after_a), Vec3(0, 0, 3));
  EXPECT_TRUE(spin(after.after_b).isZero(0.0));
}

}  // namespace peerd::replication::contact_answer_test
