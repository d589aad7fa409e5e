#include "peerd/cli/lab/scenario_command.hpp"

#include <iostream>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include "peerd/cli/lab/scenario_options.hpp"
#include "peerd/cli/shell/print.hpp"
#include "peerd/lab/live/assemble.hpp"
#include "peerd/lab/live/lab.hpp"
#include "peerd/lab/live/live_events.hpp"
#include "peerd/lab/live/live_run.hpp"
#include "peerd/lab/live/measuring.hpp"
#include "peerd/peer/config/resolve.hpp"

namespace peerd {
namespace {

namespace fs = std::filesystem;

// Sessions of two scenario runs on one computer must not meet. Each takes a port of its own from this range, below the
// ephemeral ports, which the system may give to any program.
constexpr int kPortBegin = 20000, kPortCount = 12000;

measure::ScenarioInfo info_of(const ScenarioOptions& options, const config::Scenario& scenario,
                              const SharedWorld& shared) {
  measure::ScenarioInfo info{
      scenario.name, "real", scenario.seed, {}, scenario.repeat, command_line("scenario", options)};
  info.warnings = shared.findings();
  if (!options.netem) {
    info.warnings.push_back(
        "the network is this computer's own: latency_ms, jitter_ms, loss and the like do not apply");
  }
  for (const config::ScenarioEvent& event : scenario.runs.front().events) {
    if (event.kind != config::EventKind::kKill) continue;
    info.warnings.push_back("peer " + event.peer + " was killed: what it did and believed is not in the report");
  }
  return info;
}

}  // namespace

int run_scenario(const ScenarioOptions& options, const fs::path& program) {
  config::ScenarioRequest request{options.scenario, options.configs, options.sets, options.seed,
                                  options.repeat,   !options.netem,  true};
  const auto scenario = config::read_scenario(request);
  if (!scenario) return failed(scenario.error());
  print_warnings(scenario->warnings);
  for (const config::RunSettings& run : scenario->runs) {
    if (const auto error = why_not_live(run.events)) return failed(*error);
  }
  const auto shared = share_world(scenario->world, scenario->reading, scenario->runs);
  if (!shared) return failed(shared.error());
  print_warnings(config::settings_without_effect(scenario->runs.front(), (*shared)->world.scene));
  print_warnings((*shared)->findings());

  const auto csv_rows = read_samples(options.samples);
  if (!csv_rows) return failed(csv_rows.error());
  measure::ScenarioInfo info = info_of(options, *scenario, **shared);
  info.csv_rows = *csv_rows;
  const auto out = options.out.empty() ? fs::path("out") / scenario->name : options.out;
  std::error_code error;
  fs::create_directories(out, error);
  if (error) return failed({"error: can't make the folder " + out.string() + ": " + error.message(), kSystemFailed});

  std::unique_ptr<live::Lab> lab;
  if (options.netem) {
    auto built = live::Lab::build(scenario->runs.front().peers.size());
    if (!built) return failed(built.error());
    lab = std::move(*built);
  }
  block_stop_signals();
  std::vector<measure::RunRecord> records;
  for (const config::RunSettings& run : scenario->runs) {
    const int number = static_cast<int>(records.size()) + 1;
    const int port = kPortBegin + (getpid() * 37 + number) % kPortCount;
    std::optional<measure::NetworkMeasured> network;
    if (lab) {
      if (auto set = lab->set_links(run); !set) return failed(set.error());
      if (auto on = lab->set_multicast(true); !on) return failed(on.error());  // the probes are multicast
      auto measured = lab->measure(run);
      if (!measured) return failed(measured.error());
      // The interfaces of peers that must do without multicast lose it.
      const bool multicast = run.transport.multicast != net::kMulticastNever && run.via == config::Via::kNothing;
      if (auto set = lab->set_multicast(multicast); !set) return failed(set.error());
      network = std::move(*measured);
    }
    std::vector<double> oversleep_ms;
    const LiveRun launch{.program = program,
                         .scenario = options.scenario,
                         .configs = options.configs,
                         .sets = options.sets,
                         .interface = options.interface,
                         .tcpdump = options.tcpdump,
                         .out = out,
                         .run_name = fmt::format("run-{:03}", number),
                         .port = port,
                         .lab = lab.get()};
    const auto logs = run_live(launch, run, oversleep_ms);
    if (!logs) return failed(logs.error());
    auto record = assemble(run, **shared, *logs, measuring_of(*scenario, records.size(), *csv_rows));
    if (!record) return failed(record.error());
    if (!lab) record->network_settings.clear();  // they do not apply
    if (lab) {
      network->oversleep_during_ms = std::move(oversleep_ms);
      if (auto counted = lab->count(*network); !counted) return failed(counted.error());
      record->network = std::move(network);
      if (!measure::kept_time(*record->network)) {
        info.warnings.push_back(
            fmt::format("run-{:03} does not count: this computer did not keep time (network.oversleep_ms)", number));
      }
    }
    records.push_back(std::move(*record));
  }
  const int code = print_report(info, records, scenario->expectations, out, options.json);
  if (code > 1 || options.json) return code;
  std::cout << "report: " << (out / "report.html").string() << '\n';
  return code;
}

}  // namespace peerd
