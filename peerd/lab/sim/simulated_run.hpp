#pragma once
#include "peerd/lab/live/run_assembler.hpp"
#include "peerd/lab/sim/simulation.hpp"

namespace peerd::sim {

// Simulates one run and gives its record: the logs laid side by side, the areas of interest judged and, where the
// scenario asks for it (decisions.compare), the outcomes compared with those of the same run without latency. A run
// that `progress` stops is as long as it came, 0 s where its motions had not begun; its outcomes are not compared. The
// rows of the logs are measured as they come and not kept beyond `measuring`'s limits.
[[nodiscard]] Result<measure::RunRecord> simulated_run(const config::RunSettings& run, const SharedWorld& shared,
                                                       const Observer& observer = {},
                                                       const ActionObserver& action_observer = {},
                                                       const Captures* captures = nullptr, Measuring measuring = {},
                                                       const Progress& progress = {}, PeersWatch* watch = nullptr);

// Compares the outcomes in a record of that run with those of the same run without latency, by this project's peers
// (without_latency()); none where `progress` stops the comparison.
[[nodiscard]] Result<std::optional<measure::WrongOutcomes>> compare_outcomes(const measure::RunRecord& record,
                                                                             const config::RunSettings& run,
                                                                             const SharedWorld& shared,
                                                                             const Progress& progress = {});

}  // namespace peerd::sim
