#pragma once
#include "peerd/measure/run_record.hpp"
#include "peerd/sim/simulation.hpp"

namespace peerd::sim {

// Simulates one run and gives its record: the logs laid side by side, the areas of interest judged and, where the
// scenario asks for it (decisions.compare), the outcomes compared with those of the same run without latency.
[[nodiscard]] Result<report::RunRecord> simulated_run(const config::RunSettings& run, const SharedWorld& shared,
                                                      const Observer& observer = {},
                                                      const KeyObserver& key_observer = {},
                                                      const Captures* captures = nullptr);

}  // namespace peerd::sim
