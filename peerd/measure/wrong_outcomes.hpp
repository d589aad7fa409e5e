#pragma once
#include <cstdint>

#include "peerd/measure/run_record.hpp"

namespace peerd::report {

// What peers decided between them (kind "decided"), against what happens without latency. An outcome is right if the
// truth has one of that pair within kSameTime_s, from the same side (agreement.cpp says why the side); each counts
// once.
inline constexpr double kSameTime_s = 0.25;
[[nodiscard]] WrongOutcomes wrong_outcomes(const RunRecord& run, const RunRecord& truth);

}  // namespace peerd::report
