#include "replication/objects/updates/rounding.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/time.hpp"

namespace peerd::replication {
namespace {

// A model that is expected to err by less than this part of the threshold won't be corrected before its time is up,
// unless its rounding asks for that.
constexpr double kAllButExact = 1.0 / 16.0, kFinest = 1.0 / 64.0;

// The factor by which such a model is rounded more finely: the error by rounding grows with the square of time, from a
// 16th of the threshold at the kind's horizon, and should be half of it at the time threshold.
double finer(MotionKind kind, Duration time_threshold) {
  const double horizons = to_seconds(time_threshold) / std::exp2(horizon_log2_s(kind));
  return std::clamp(8.0 / (horizons * horizons), kFinest, 1.0);
}

}  // namespace

// With snapshots, which go out whatever the thresholds, the tight threshold says what is close.
Tolerance rounding_tolerance(const PublishPolicy& policy, double threshold_m, double bounding_radius_m, MotionKind kind,
                             double expected_error_m) {
  assert(threshold_m >= 0.0 && bounding_radius_m >= 0.0);
  double distance_m = policy.snapshots_hz > 0 ? std::min(threshold_m, policy.tight_threshold_m) : threshold_m;
  if (policy.wanted_error_m > 0.0) distance_m = std::min(distance_m, policy.wanted_error_m);
  if (expected_error_m < kAllButExact * distance_m) distance_m *= finer(kind, policy.time_threshold);
  // An orientation is rounded by a quarter of this at most: that moves the surface by half of the threshold.
  const double turn_rad = bounding_radius_m > 0.0 ? 2.0 * threshold_m / bounding_radius_m : policy.angle_threshold_rad;
  return {distance_m, std::min(policy.angle_threshold_rad, turn_rad)};
}

}  // namespace peerd::replication
