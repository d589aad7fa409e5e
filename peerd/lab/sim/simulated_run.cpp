#include "peerd/lab/sim/simulated_run.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>

#include "peerd/lab/measure/wrong_outcomes.hpp"

namespace peerd::sim {

bool Stop::operator()(std::optional<double> run_s) {
  if (!progress_ || progress_(run_s) || run_s >= duration_s_) return true;
  at_s_ = std::max(0.0, run_s.value_or(0.0));
  return false;
}

Result<measure::RunRecord> simulated_run(const config::RunSettings& run, const SharedWorld& shared,
                                         const Observer& observer, const ActionObserver& action_observer,
                                         const Captures* captures, Measuring measuring, const Progress& progress,
                                         PeersWatch* watch) {
  auto assembler = RunAssembler::make(run, shared, std::move(measuring));
  if (!assembler) return std::unexpected(assembler.error());
  std::optional<measure::InterestRecord> interest;
  Stop stop(progress, run.duration_s);
  const auto logs =
      simulate(run, shared, observer, action_observer, &interest, captures, assembler->get(), std::ref(stop), watch);
  if (!logs) return std::unexpected(logs.error());
  auto record = record_of(**assembler, *logs, stop, run, shared, progress);
  if (record) record->interest = std::move(interest);
  return record;
}

Result<measure::RunRecord> record_of(RunAssembler& assembler, const std::vector<PeerLog>& logs, const Stop& stop,
                                     const config::RunSettings& run, const SharedWorld& shared,
                                     const Progress& progress) {
  if (stop.at_s() == 0.0) {
    measure::RunRecord nothing;
    nothing.stopped = true;
    return nothing;
  }
  auto record = assembler.finish(logs, stop.at_s());
  if (!record || !run.compare_outcomes || record->stopped) return record;
  auto wrong = compare_outcomes(*record, run, shared, progress);
  if (!wrong) return std::unexpected(wrong.error());
  record->stopped = !*wrong;
  record->wrong = *wrong;
  return record;
}

Result<std::optional<measure::WrongOutcomes>> compare_outcomes(const measure::RunRecord& record,
                                                               const config::RunSettings& run,
                                                               const SharedWorld& shared, const Progress& progress) {
  const config::RunSettings ideal = without_latency(run);
  auto assembler = RunAssembler::make(ideal, shared, {.limits = {0, 0, 0}, .parts = {}});
  if (!assembler) return std::unexpected(assembler.error());
  Stop stop(progress, ideal.duration_s);
  const auto logs = simulate(ideal, shared, {}, {}, nullptr, nullptr, assembler->get(), std::ref(stop));
  if (!logs) return std::unexpected(logs.error());
  if (stop.at_s()) return std::nullopt;
  const auto truth = (*assembler)->finish(*logs);
  if (!truth) return std::unexpected(truth.error());
  return measure::wrong_outcomes(record, *truth);
}

}  // namespace peerd::sim
