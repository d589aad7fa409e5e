#include "peerd/sim/simulated_run.hpp"

#include <optional>
#include <utility>

#include "peerd/measure/wrong_outcomes.hpp"
#include "peerd/scenario/assemble.hpp"

namespace peerd::sim {

Result<report::RunRecord> simulated_run(const config::RunSettings& run, const SharedWorld& shared,
                                        const Observer& observer, const KeyObserver& key_observer,
                                        const Captures* captures) {
  std::optional<report::InterestRecord> interest;
  const auto logs = simulate(run, shared, observer, key_observer, &interest, captures);
  if (!logs) return std::unexpected(logs.error());
  auto record = assemble(run, shared, *logs);
  if (!record) return record;
  record->interest = std::move(interest);
  if (!run.compare_outcomes) return record;
  const config::RunSettings ideal = without_latency(run);
  const auto true_logs = simulate(ideal, shared);
  if (!true_logs) return std::unexpected(true_logs.error());
  const auto truth = assemble(ideal, shared, *true_logs);
  if (!truth) return std::unexpected(truth.error());
  record->wrong = report::wrong_outcomes(*record, *truth);
  return record;
}

}  // namespace peerd::sim
