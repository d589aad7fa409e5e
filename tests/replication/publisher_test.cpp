#include "replication/publisher.hpp"

#include <gtest/gtest.h>

#include "tests/replication/worlds.hpp"

namespace peerd::replication {
namespace {

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

TEST(AsModel, FirstOrderDropsTheAccelerationAlone) {
  KinematicState truth = moving({1, 2, 3}, {4, 5, 6}, {7, 8, 9});
  truth.angular_velocity_body = {1, 0, 0};
  EXPECT_TRUE(same_bits(as_model(ModelOrder::kSecond, truth), truth));
  KinematicState expected = truth;
  expected.acceleration.setZero();
  EXPECT_TRUE(same_bits(as_model(ModelOrder::kFirst, truth), expected));
}

TEST(PublishReasonName, IsDistinctForEach) {
  EXPECT_STREQ(to_string(PublishReason::kFirst), "first");
  EXPECT_STREQ(to_string(PublishReason::kError), "error");
  EXPECT_STREQ(to_string(PublishReason::kTime), "time");
  EXPECT_STREQ(to_string(PublishReason::kJoiner), "joiner");
}

}  // namespace
}  // namespace peerd::replication
