#pragma once
#include <optional>
#include <vector>

#include "peerd/lab/live/run_assembler.hpp"
#include "peerd/lab/sim/simulation.hpp"

namespace peerd::sim {

// Simulates one run and gives its record: the logs laid side by side, the areas of interest judged and, where the
// scenario asks for it (decisions.compare), the outcomes compared with those of the same run without latency. A run
// that `progress` stops is as long as it came, 0 s where its motions had not begun; its outcomes are not compared.
// One whose comparison is stopped counts as stopped. The rows of the logs are measured as they come and not kept
// beyond `measuring`'s limits.
[[nodiscard]] Result<measure::RunRecord> simulated_run(const config::RunSettings& run, const SharedWorld& shared,
                                                       const Observer& observer = {},
                                                       const ActionObserver& action_observer = {},
                                                       const Captures* captures = nullptr, Measuring measuring = {},
                                                       const Progress& progress = {}, PeersWatch* watch = nullptr);

// Asks `progress` whether a run goes on, and notes when it was stopped. It can't be stopped once `duration_s` is over:
// the updates that still have to arrive belong to a whole run.
class Stop {
 public:
  Stop(const Progress& progress, double duration_s) : progress_(progress), duration_s_(duration_s) {}
  // False: the run ends at run_s, the time since its motions began.
  bool operator()(std::optional<double> run_s);
  // Seconds since the motions began, 0 before that; none: the run was not stopped.
  [[nodiscard]] std::optional<double> at_s() const { return at_s_; }

 private:
  const Progress& progress_;
  double duration_s_;
  std::optional<double> at_s_;
};

// The record of a run whose peers have left these logs, its outcomes compared where the scenario asks for it.
[[nodiscard]] Result<measure::RunRecord> record_of(RunAssembler& assembler, const std::vector<PeerLog>& logs,
                                                   const Stop& stop, const config::RunSettings& run,
                                                   const SharedWorld& shared, const Progress& progress);

// Compares the outcomes in a record of that run with those of the same run without latency, by this project's peers
// (without_latency()); none where `progress` stops the comparison.
[[nodiscard]] Result<std::optional<measure::WrongOutcomes>> compare_outcomes(const measure::RunRecord& record,
                                                                             const config::RunSettings& run,
                                                                             const SharedWorld& shared,
                                                                             const Progress& progress = {});

}  // namespace peerd::sim
