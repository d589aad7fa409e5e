#pragma once
#include <cstdint>

#include "peerd/lab/measure/run_record.hpp"

namespace peerd::measure {

// Compares the outcomes that peers decided (kind "decided") with those of the run without latency. An outcome is right
// if the truth has an outcome of that pair within kSameTime_s on the same side (same_side()); each true outcome counts
// once.
inline constexpr double kSameTime_s = 0.25;
[[nodiscard]] WrongOutcomes wrong_outcomes(const RunRecord& run, const RunRecord& truth);

}  // namespace peerd::measure
