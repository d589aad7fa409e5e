#pragma once
#include <string>
#include <vector>

#include "peerd/lab/sim/simulated_run.hpp"

namespace peerd::baselines {

// One run of a scenario in the simulator by the system that its settings name: this project's peers
// (sim::simulated_run), or another system's computers (run.baseline) on the same simulated network, with the same
// measures. The error says what of a scenario another system does not have.
[[nodiscard]] Result<measure::RunRecord> run_of_any_system(const config::RunSettings& run, const SharedWorld& shared,
                                                           const sim::Observer& observer = {},
                                                           const sim::ActionObserver& action_observer = {},
                                                           const sim::Captures* captures = nullptr,
                                                           Measuring measuring = {},
                                                           const sim::Progress& progress = {});

}  // namespace peerd::baselines
