#pragma once
#include <vector>

#include "peerd/measure/run_record.hpp"

namespace peerd::report {

// How long a bar of output lasts: a second, as in the seed; a rounder number of seconds when a run is so long that
// seconds would be hairs.
[[nodiscard]] double output_bin_s(double duration_s);

// Output of a peer [kB/s, kB = 1000 bytes] in each bin; the last may be short and is divided by what it has.
[[nodiscard]] std::vector<double> output_rates(const RunRecord& run, PeerId sender);

}  // namespace peerd::report
