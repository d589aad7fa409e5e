#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "peerd/lab/live/assemble.hpp"
#include "peerd/lab/measure/summary.hpp"
#include "peerd/lab/sim/simulated_run.hpp"
#include "tests/must.hpp"

// A scenario of the repository, run on the simulated network, with what its report says of it.
namespace peerd::sim::testing_support {

inline const std::string kEq47 = PEERD_SOURCE_DIR "/configs/scenarios/eq47.toml";

struct Ran {
  config::RunSettings settings;
  std::vector<PeerLog> logs;
  measure::RunRecord record;
  nlohmann::ordered_json summary;  // this run's part

  // One observer's view of one object.
  [[nodiscard]] nlohmann::ordered_json view(const std::string& observer, const std::string& path) const {
    for (const auto& o : summary["objects"]) {
      if (o["observer"] == observer && o["path"] == path) return o;
    }
    throw std::runtime_error("nobody called " + observer + " observes " + path);
  }
  [[nodiscard]] double mean_error_m(const std::string& observer, const std::string& path) const {
    return view(observer, path)["ghost_error_m"]["mean"].get<double>();
  }
  [[nodiscard]] std::uint64_t updates(const std::string& path) const {
    for (const auto& o : summary["objects"]) {
      if (o["path"] == path) return o["updates_sent"].get<std::uint64_t>();
    }
    throw std::runtime_error("nobody observes " + path);
  }
  // Contacts of that kind that a peer stated, in order of time.
  [[nodiscard]] std::vector<measure::ContactRow> contacts(PeerId peer, const std::string& kind) const {
    std::vector<measure::ContactRow> rows;
    std::ranges::copy_if(record.contacts, std::back_inserter(rows),
                         [&](const auto& c) { return c.peer == peer && c.kind == kind; });
    return rows;
  }
};

inline config::Scenario scenario_of(const std::filesystem::path& file, std::vector<std::string> sets = {},
                                    std::vector<std::filesystem::path> configs = {}) {
  return must(
      config::read_scenario({.file = file, .configs = std::move(configs), .sets = std::move(sets), .seed = {}}));
}

// Its runs, in order. Throws the error's sentence.
inline std::vector<Ran> run_scenario(const std::string& file, const std::vector<std::string>& sets = {},
                                     const std::vector<std::filesystem::path>& configs = {}) {
  const config::Scenario scenario = scenario_of(file, sets, configs);
  const auto shared = must(share_world(scenario.world, scenario.reading, scenario.runs));
  std::vector<Ran> runs;
  for (const config::RunSettings& settings : scenario.runs) {
    Ran& ran = runs.emplace_back();
    ran.settings = settings;
    ran.logs = must(simulate(settings, *shared));
    ran.record = must(assemble(settings, *shared, ran.logs));
    if (settings.compare_outcomes) ran.record.wrong = must(compare_outcomes(ran.record, settings, *shared));
    ran.summary = measure::summarise({scenario.name, "sim", scenario.seed, {}}, {&ran.record, 1})["runs"][0];
  }
  return runs;
}

// Three peers have the same outcomes of the contacts that are decided for all.
inline void expect_one_outcome(const Ran& ran, int decided_at_least) {
  const auto& shared = ran.summary["collisions"]["shared"];
  EXPECT_GE(shared["decided"], decided_at_least);
  EXPECT_EQ(shared["agreed"], 2 * shared["decided"].get<int>());
  EXPECT_EQ(shared["disagreed"], 0);
  EXPECT_EQ(shared["missed"], 0);
  EXPECT_EQ(shared["spurious"], 0);
}

// One run of eq47: its sweep set to one row of the table, and whatever else.
inline Ran run_eq47(const std::string& approach, int order, double latency_ms, std::vector<std::string> sets = {}) {
  sets.insert(sets.begin(), {"replication.approach=" + approach, "replication.order=" + std::to_string(order),
                             "network.latency_ms=" + std::to_string(latency_ms)});
  auto runs = run_scenario(kEq47, sets);
  EXPECT_EQ(runs.size(), 1u);
  return std::move(runs.front());
}

}  // namespace peerd::sim::testing_support
