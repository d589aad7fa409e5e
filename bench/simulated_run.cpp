#include "simulated_run.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>
#include <stdexcept>

#include "peerd/lab/baselines/baseline_run.hpp"
#include "peerd/lab/live/assemble.hpp"
#include "peerd/lab/measure/summary.hpp"
#include "peerd/lab/sim/simulation.hpp"
#include "peerd/peer/config/scenario.hpp"

namespace peerd::bench {
namespace {

const std::filesystem::path kConfigs = PEERD_SOURCE_DIR "/configs";
constexpr double kHeaderOfRecords_bytes = 18.0;  // proto/README.md

template <class T>
T must(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().text);
  return *std::move(result);
}

struct Mean {
  double sum = 0.0;
  std::size_t count = 0;
  void add(double x) { sum += x, ++count; }
  [[nodiscard]] double value() const { return count == 0 ? 0.0 : sum / static_cast<double>(count); }
};

// A run that has been read, with its world.
struct ReadyRun {
  config::Scenario scenario;
  std::unique_ptr<const SharedWorld> shared;
  [[nodiscard]] const config::RunSettings& settings() const { return scenario.runs.front(); }
};
ReadyRun ready(const SimulatedRun& run) {
  config::ScenarioRequest request;
  request.file = kConfigs / "scenarios" / (run.scenario + ".toml");
  request.configs = {kConfigs / (run.config + ".toml")};
  request.sets = run.sets;
  request.sets.push_back("network.latency_ms=" + std::to_string(run.latency_ms));
  request.sets.push_back("duration_s=" + std::to_string(run.duration_s));
  ReadyRun read{must(config::read_scenario(request)), nullptr};
  if (read.scenario.runs.size() != 1) {
    throw std::runtime_error(run.config + " on " + run.scenario + ": one run was meant");
  }
  read.shared = must(share_world(read.scenario.world));
  return read;
}

// The record of the run, by whichever system its configuration names.
measure::RunRecord played_record(const ReadyRun& read) {
  if (read.settings().baseline.system != config::BaselineSystem::kNone) {
    return must(baselines::run_of_any_system(read.settings(), *read.shared));
  }
  std::optional<measure::InterestRecord> interest;  // none: nobody has an area of interest
  const auto logs = must(sim::simulate(read.settings(), *read.shared, {}, {}, &interest));
  measure::RunRecord record = must(assemble(read.settings(), *read.shared, logs));
  record.interest = interest;
  return record;
}

nlohmann::ordered_json summary_of(const SimulatedRun& run, const ReadyRun& read, const measure::RunRecord& record) {
  return measure::summarise({run.scenario, "sim", read.scenario.seed, {}}, {&record, 1})["runs"][0];
}

}  // namespace

replication::PublishPolicy policy_in(const std::string& config, const std::vector<std::string>& sets) {
  return ready({"crowd", config, 100.0, 1.0, sets}).settings().replication.policy;
}

nlohmann::ordered_json summary_of(const SimulatedRun& run) {
  const ReadyRun read = ready(run);
  return summary_of(run, read, played_record(read));
}

Outcome simulate(const SimulatedRun& run) {
  const ReadyRun read = ready(run);
  const measure::RunRecord record = played_record(read);
  const auto summary = summary_of(run, read, record);
  Outcome outcome;
  if (summary["objects"].empty()) outcome.wrong = "nobody saw anything";
  if (summary["collisions"]["shared"]["disagreed"] != 0) outcome.wrong = "peers disagree on an outcome";
  Mean error, updates;
  std::set<std::string> objects;
  for (const auto& row : summary["objects"]) {
    error.add(row["ghost_error_m"]["mean"].get<double>());
    updates.add(row["updates_sent"].get<double>() / run.duration_s);
    objects.insert(row["path"].get<std::string>());
  }
  const auto& traffic = summary["traffic"];
  outcome.bytes_per_s = traffic["bytes_per_s"].get<double>();
  outcome.bytes_with_udp_per_s =
      outcome.bytes_per_s + kUdpHeader_bytes * traffic["packets"].get<double>() / run.duration_s;
  std::set<std::pair<double, PeerId>> instants;
  double update_bytes = 0.0;
  for (const measure::UpdateSent& u : record.updates) {
    update_bytes += u.bytes;
    instants.emplace(u.t_s, u.sender);
  }
  update_bytes += (kUdpHeader_bytes + kHeaderOfRecords_bytes) * static_cast<double>(instants.size());
  outcome.update_bytes_per_s = update_bytes / run.duration_s;
  outcome.ghost_error_m = error.value();
  outcome.updates_per_s = updates.value() * static_cast<double>(objects.size());
  return outcome;
}

std::optional<double> bytes_for(Tradeoff curve, double error_m, double Outcome::*bytes) {
  std::optional<double> least;
  const auto take = [&](double b) { least = std::min(least.value_or(b), b); };
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const Outcome& p = curve[i];
    if (p.ghost_error_m <= error_m) take(p.*bytes);
    if (i == 0) continue;
    const Outcome& q = curve[i - 1];
    if ((p.ghost_error_m < error_m) == (q.ghost_error_m < error_m)) continue;
    const double s = std::log(error_m / q.ghost_error_m) / std::log(p.ghost_error_m / q.ghost_error_m);
    take(q.*bytes * std::pow(p.*bytes / (q.*bytes), s));
  }
  return least;
}

std::vector<double> thresholds_m(bool quick) {
  return quick ? std::vector<double>{1.0, 0.1} : std::vector<double>{2.0, 1.4, 1.0, 0.7, 0.5, 0.2, 0.1, 0.05};
}
std::vector<std::string> best_at(double threshold_m) {
  return {"replication.wanted_error_m=" + std::to_string(threshold_m),
          "replication.error_threshold_m=" + std::to_string(std::max(1.0, threshold_m))};
}
std::vector<std::string> dead_reckoning_at(double threshold_m) {
  return {"replication.error_threshold_m=" + std::to_string(threshold_m)};
}

}  // namespace peerd::bench
