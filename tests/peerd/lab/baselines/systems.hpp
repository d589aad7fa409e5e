#pragma once
#include "peerd/lab/baselines/baseline_run.hpp"
#include "tests/sim/run_scenario.hpp"

// Runs of a scenario by other systems, and what their reports say.
namespace peerd::baselines::testing_support {

inline const std::string kMeeting = PEERD_SOURCE_DIR "/tests/sim/worlds/meeting.toml";
inline const std::string kKeys = PEERD_SOURCE_DIR "/configs/scenarios/keys.toml";

inline Result<measure::RunRecord> try_system(const std::string& scenario_file, const std::string& name,
                                             std::vector<std::string> sets = {}) {
  const config::Scenario scenario =
      must(config::read_scenario({.file = scenario_file,
                                  .configs = {PEERD_SOURCE_DIR "/configs/baselines/" + name + ".toml"},
                                  .sets = std::move(sets),
                                  .seed = {},
                                  .sweep = false}));
  const auto shared = must(share_world(scenario.world, scenario.reading, scenario.runs));
  return run_of_any_system(scenario.runs.front(), *shared);
}
inline measure::RunRecord run_system(const std::string& scenario_file, const std::string& name,
                                     std::vector<std::string> sets = {}) {
  return must(try_system(scenario_file, name, std::move(sets)));
}

// The mean of a distance over all samples of one observer.
template <class Distance>
double mean_m(const measure::RunRecord& record, PeerId observer, Distance distance) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const measure::GhostSample& sample : record.ghost_samples) {
    if (sample.observer != observer) continue;
    sum += distance(sample);
    ++count;
  }
  EXPECT_GT(count, 0u);
  return sum / static_cast<double>(count);
}
inline double seen_error_m(const measure::GhostSample& s) { return (s.seen.position - s.truth.position).norm(); }

inline std::vector<measure::ContactRow> contacts_of(const measure::RunRecord& record, const std::string& peer,
                                                    const std::string& kind) {
  std::vector<measure::ContactRow> rows;
  for (const measure::PeerInfo& info : record.peers) {
    std::ranges::copy_if(record.contacts, std::back_inserter(rows), [&](const measure::ContactRow& row) {
      return info.name == peer && row.peer == info.peer && row.kind == kind;
    });
  }
  return rows;
}

}  // namespace peerd::baselines::testing_support
