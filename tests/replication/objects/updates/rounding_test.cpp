#include "replication/objects/updates/rounding.hpp"

#include <gtest/gtest.h>

#include <string>

namespace peerd::replication::rounding_test {

struct Case {
  const char* name;
  double threshold_m, bounding_radius_m;
  MotionKind kind;
  double expected_error_m;
  std::uint32_t snapshots_hz;
  double wanted_error_m;
  int time_threshold_s;
  double distance_m, angle_rad;
};
class Rounding : public testing::TestWithParam<Case> {};
TEST_P(Rounding, IsByTheTightestThresholdInForce) {
  const Case& c = GetParam();
  PublishPolicy policy;
  policy.tight_threshold_m = 0.01;
  policy.angle_threshold_rad = 0.05;
  policy.snapshots_hz = c.snapshots_hz;
  policy.wanted_error_m = c.wanted_error_m;
  policy.time_threshold = std::chrono::seconds(c.time_threshold_s);
  const Tolerance tolerance =
      rounding_tolerance(policy, c.threshold_m, c.bounding_radius_m, c.kind, c.expected_error_m);
  EXPECT_NEAR(tolerance.distance_m, c.distance_m, 1e-15);
  EXPECT_NEAR(tolerance.angle_rad, c.angle_rad, 1e-15);
}
constexpr MotionKind kSecond = MotionKind::kSecond, kTurning = MotionKind::kTurning;
// A model that is expected to err by less than a 16th of the threshold is rounded by 8 / n^2 of it, n being the time
// threshold in horizons of its kind: 1 s for a second order, 4 s for a turning one.
INSTANTIATE_TEST_SUITE_P(
    Table, Rounding,
    testing::Values(Case{"Threshold", 0.5, 0, kSecond, 0.5, 0, 0, 5, 0.5, 0.05},
                    Case{"SnapshotsByTheTightOne", 0.5, 0, kSecond, 0.5, 20, 0, 5, 0.01, 0.05},
                    Case{"SnapshotsWithinATighterOne", 0.005, 0, kSecond, 0.5, 20, 0, 5, 0.005, 0.05},
                    Case{"WantedError", 0.5, 0, kSecond, 0.5, 0, 0.003, 5, 0.003, 0.05},
                    Case{"WantedErrorAboveTheThreshold", 0.5, 0, kSecond, 0.5, 0, 0.7, 5, 0.5, 0.05},
                    Case{"NearlyExact", 0.5, 0, kSecond, 0.03, 0, 0, 5, 0.5 * 8 / 25, 0.05},
                    Case{"JustNotNearlyExact", 0.5, 0, kSecond, 0.03125, 0, 0, 5, 0.5, 0.05},
                    Case{"NearlyExactForLong", 0.5, 0, kSecond, 0.0, 0, 0, 60, 0.5 / 64, 0.05},
                    Case{"NearlyExactAndLastingAnyway", 0.5, 0, kTurning, 0.0, 0, 0, 5, 0.5, 0.05},
                    Case{"NearlyExactAndLastingLonger", 0.5, 0, kTurning, 0.0, 0, 0, 20, 0.5 * 8 / 25, 0.05},
                    Case{"LargeObject", 0.01, 10, kSecond, 0.5, 0, 0, 5, 0.01, 0.002},
                    Case{"SmallObject", 0.5, 0.1, kSecond, 0.5, 0, 0, 5, 0.5, 0.05}),
    [](const auto& c) { return std::string(c.param.name); });

}  // namespace peerd::replication::rounding_test
