#include "replication/settings/policy/publish_policy.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::publish_policy_test {

using namespace test;

struct Case {
  const char* name;
  GhostError error;
  std::optional<Duration> last_sent;  // before now
  std::optional<PublishReason> expected;
};
class Due : public testing::TestWithParam<Case> {};
TEST_P(Due, SaysWhy) {
  PublishPolicy policy;
  policy.angle_threshold_rad = 0.1;
  policy.time_threshold = 5s;
  const auto& [name, error, ago, expected] = GetParam();
  const SimTime now = sim(100s);
  EXPECT_EQ(due(policy, 0.5, error, ago ? std::optional(now - *ago) : std::nullopt, now), expected);
}
INSTANTIATE_TEST_SUITE_P(Table, Due,
                         testing::Values(Case{"NeverSent", {0, 0}, std::nullopt, PublishReason::kFirst},
                                         Case{"FirstBeatsError", {9, 9}, std::nullopt, PublishReason::kFirst},
                                         Case{"AllWell", {0.4, 0.09}, 1s, std::nullopt},
                                         Case{"AtTheThresholdIsStillWell", {0.5, 0.1}, 1s, std::nullopt},
                                         Case{"TooFar", {0.500001, 0}, 1s, PublishReason::kError},
                                         Case{"TurnedTooFar", {0, 0.100001}, 1s, PublishReason::kError},
                                         Case{"ErrorBeatsTime", {1, 0}, 6s, PublishReason::kError},
                                         Case{"NotYetTime", {0, 0}, 5s - 1ns, std::nullopt},
                                         Case{"Time", {0, 0}, 5s, PublishReason::kTime}),
                         [](const auto& c) { return std::string(c.param.name); });

TEST(DueAtRest, AcknowledgedRestingObjectsWaitLonger) {
  PublishPolicy policy;
  policy.time_threshold = 5s;
  policy.resting_time_threshold = 20s;
  const auto after = [&](Duration ago) { return due(policy, 0.5, {}, sim(100s) - ago, sim(100s), true); };
  EXPECT_EQ(after(20s - 1ns), std::nullopt);
  EXPECT_EQ(after(20s), PublishReason::kTime);
  policy.resting_time_threshold = 0s;  // not below what counts for all
  EXPECT_EQ(after(5s - 1ns), std::nullopt);
  EXPECT_EQ(after(5s), PublishReason::kTime);
}

TEST(GhostError, IsEuclideanNotPerAxis) {
  const GhostError e = ghost_error(moving({0.4, 0.4, 0.4}), moving({0, 0, 0}));
  EXPECT_NEAR(e.distance_m, 0.4 * std::sqrt(3.0), 1e-15);  // above 0.5, though no axis is
}

TEST(GhostError, TakesTheSmallestAngleWhateverTheQuaternionsSign) {
  KinematicState truth, ghost;
  truth.orientation = Quat(Eigen::AngleAxisd(0.3, Vec3::UnitY()));
  EXPECT_NEAR(ghost_error(truth, ghost).angle_rad, 0.3, 1e-12);
  ghost.orientation.coeffs() = -truth.orientation.coeffs();
  EXPECT_NEAR(ghost_error(truth, ghost).angle_rad, 0.0, 1e-7);
}

// A turn moves the farthest vertex along a chord.
TEST(GhostError, OfTheSurfaceCountsTheTurnByWhatItMoves) {
  KinematicState truth = moving({3, 0, 0}), ghost = moving({3, 4, 0});
  truth.orientation = Quat(Eigen::AngleAxisd(std::numbers::pi / 3, Vec3::UnitZ()));
  EXPECT_NEAR(ghost_error(truth, ghost, 2.5).distance_m, 4.0 + 2.5, 1e-12);
  EXPECT_EQ(ghost_error(truth, ghost).distance_m, 4.0);
}

// A displacement along the diagonal of the axes counts by its length: an object at the threshold needs no update,
// whichever way the displacement points, and one a hair beyond it does.
TEST(GhostError, OnTheDiagonalIsHeldAgainstTheThresholdLikeAnyOther) {
  PublishPolicy policy;
  const SimTime now = sim(100s);
  for (const Vec3& way : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(1, 1, 0), Vec3(-1, 1, 1), Vec3(1, -1, -1)}) {
    const Vec3 at_threshold = 0.5 * way.normalized();
    const GhostError at = ghost_error(moving(Vec3::Zero()), moving((1 - 1e-15) * at_threshold));
    const GhostError beyond = ghost_error(moving(Vec3::Zero()), moving((1 + 1e-12) * at_threshold));
    EXPECT_EQ(due(policy, 0.5, at, now - 1s, now), std::nullopt) << way.transpose();
    EXPECT_EQ(due(policy, 0.5, beyond, now - 1s, now), PublishReason::kError) << way.transpose();
  }
}

// Two orientations are at most half a turn apart; there q and -q are equally near.
TEST(GhostError, OfTwoOrientationsHalfATurnApartIsPi) {
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 2, 2)}) {
    for (const double sign : {1.0, -1.0}) {
      const Vec3 n = axis.normalized();
      KinematicState truth = moving({1, 2, 3}), ghost = truth;
      truth.orientation = Quat(0.5, 0.5, -0.5, 0.5);
      ghost.orientation = truth.orientation * Quat(0.0, n.x(), n.y(), n.z());
      ghost.orientation.coeffs() *= sign;
      const GhostError error = ghost_error(truth, ghost);
      EXPECT_EQ(error.distance_m, 0.0);
      EXPECT_NEAR(error.angle_rad, std::numbers::pi, 1e-15);
      EXPECT_EQ(due({}, 0.5, error, sim(99s), sim(100s)), PublishReason::kError);
    }
  }
}

// ---- the budget ----

TEST(Urgency, DependsOnErrorTimeAndViewers) {
  const PublishPolicy policy;  // 3 degrees, 5 s
  const auto of = [&](double distance_m, double angle_rad, Duration since, double viewed_from_m) {
    return urgency(policy, 0.5, {distance_m, angle_rad}, sim(100s), sim(100s + since), viewed_from_m);
  };
  EXPECT_DOUBLE_EQ(of(1.5, 0.0, 1s, 0.0), 3.0);
  EXPECT_DOUBLE_EQ(of(1.5, 5.0 * policy.angle_threshold_rad, 1s, 0.0), 5.0);
  EXPECT_DOUBLE_EQ(of(1.5, 0.0, 4s, 0.0), 12.0) << "nothing waits for ever";
  EXPECT_DOUBLE_EQ(of(1.5, 0.0, 20s, 0.0), 80.0);
  EXPECT_DOUBLE_EQ(of(1.5, 0.0, 1s, 1.0), 3.0);
  EXPECT_DOUBLE_EQ(of(1.5, 0.0, 1s, 30.0), 0.1);
  EXPECT_GT(urgency(policy, 0.5, {}, std::nullopt, sim(100s), 0.0), 1e6) << "a receiver has no state of it";
  EXPECT_EQ(urgency(policy, 0.0, {}, sim(100s), sim(100s), 0.0), 0.0) << "no threshold, no error";
}

TEST(AsModel, FirstOrderDropsTheAccelerationAlone) {
  KinematicState truth = moving({1, 2, 3}, {4, 5, 6}, {7, 8, 9});
  truth.angular_velocity_body = {1, 0, 0};
  EXPECT_TRUE(same_bits(as_model(ModelOrder::kSecond, truth).state, truth));
  KinematicState expected = truth;
  expected.acceleration.setZero();
  EXPECT_TRUE(same_bits(as_model(ModelOrder::kFirst, truth).state, expected));
}

TEST(PublishReasonName, IsDistinctForEach) {
  EXPECT_STREQ(to_string(PublishReason::kFirst), "first");
  EXPECT_STREQ(to_string(PublishReason::kError), "error");
  EXPECT_STREQ(to_string(PublishReason::kTime), "time");
  EXPECT_STREQ(to_string(PublishReason::kJoiner), "joiner");
  EXPECT_STREQ(to_string(PublishReason::kGain), "gain");
}

}  // namespace peerd::replication::publish_policy_test
