#pragma once
#include <optional>
#include <span>
#include <vector>

#include "core/scene/scene.hpp"
#include "peerd/lab/measure/run_record.hpp"
#include "peerd/peer/config/resolve.hpp"

namespace peerd::baselines {

// A picture of an object is the one that its owner sees, or the one that an observer sees.
enum class Picture { kOwners, kObservers };

// Whether the truth leaves its place.
[[nodiscard]] bool moves(std::span<const measure::GhostSample> view);

// How late [s] a picture shows an object: the shift of the truth, of 0 to kDelayMax_s, at which the mean distance
// between the two is least. The samples are one view's, by time. None: the truth stands, or the samples are farther
// apart than kSampleStepMax_s.
inline constexpr double kDelayMax_s = 1.5, kSampleStepMax_s = 0.06;
[[nodiscard]] std::optional<double> delay_s(std::span<const measure::GhostSample> view, Picture picture);

// A key that changes the velocity of an object of the peer that presses it.
struct KeyMove {
  double at_s = 0.0;
  ObjectId object;
};
[[nodiscard]] std::vector<KeyMove> key_moves(const config::RunSettings& run,
                                             std::span<const config::PeerObjects> objects, const Scene& scene);

// How long [s] after `at_s` a picture first has the object kLeaves_m farther off its course than before: the straight
// way through its places at `at_s` and kCourse_s earlier. None: it never leaves, or the samples do not reach so far
// back.
inline constexpr double kLeaves_m = 0.01, kCourse_s = 0.25;
[[nodiscard]] std::optional<double> response_s(std::span<const measure::GhostSample> view, Picture picture,
                                               double at_s);

}  // namespace peerd::baselines
