#pragma once
#include <vector>

#include "peerd/lab/measure/run_record.hpp"

namespace peerd::report {

// The length of an output bin: a second, as in the thesis, or a rounder number of seconds where a run is so long that
// bars of a second would be hairlines.
[[nodiscard]] double output_bin_s(double duration_s);

// The output of a peer in each bin [kB/s, kB = 1000 bytes]. The last bin may be shorter and is divided by its own
// length.
[[nodiscard]] std::vector<double> output_rates(const measure::RunRecord& run, PeerId sender);

}  // namespace peerd::report
