#include "peerd/commands/sim_command.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iostream>

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include "peerd/commands/print.hpp"
#include "peerd/commands/problems.hpp"
#include "peerd/commands/scenario_options.hpp"
#include "peerd/config/resolve.hpp"
#include "peerd/node/describe.hpp"
#include "peerd/sim/simulated_run.hpp"

namespace peerd {

int run_sim(const ScenarioOptions& options) {
  const auto scenario = config::read_scenario({.file = options.scenario,
                                               .configs = options.configs,
                                               .sets = options.sets,
                                               .seed = options.seed,
                                               .repeat = options.repeat});
  if (!scenario) return failed(scenario.error());
  print_warnings(scenario->warnings);
  const auto shared = share_world(scenario->world, scenario->reading);
  if (!shared) return failed(shared.error());
  const Scene& scene = (*shared)->world.scene;
  print_warnings(config::motions_without_effect(scenario->runs.front(), scene));

  report::ScenarioInfo info{scenario->name, "sim", scenario->seed, {}, scenario->repeat, command_line("sim", options)};
  for (const std::string& line : (*shared)->model->unsupported) info.warnings.push_back("unsupported: " + line);
  for (const std::string& line : info.warnings) std::cerr << line << '\n';

  sim::Observer observer;
  if (options.verbose) {
    observer = [&](HostTime now, const PeerNode& node, const replication::Output& output) {
      const auto line = describe(output, scene);
      if (!line || !node.start()) return;
      const double t_s = to_seconds(now.time_since_epoch() - node.start()->time_since_epoch());
      std::cerr << fmt::format("{:9.4f} s  peer {}: {}\n", t_s, node.peer().id().value, line->text);
    };
  }
  // A key without its intended effect is a finding about the scenario. It is printed once and is part of the report.
  const sim::KeyObserver key_observer = [&](HostTime now, const PeerNode& node, const KeyReport& key) {
    for (const LogLine& line : describe(key, scene)) {
      const double t_s = to_seconds(now.time_since_epoch() - node.start()->time_since_epoch());
      if (options.verbose) {
        std::cerr << fmt::format("{:9.4f} s  peer {}: {}\n", t_s, node.peer().id().value, line.text);
      }
      if (key.done()) continue;
      const std::string warning = fmt::format("peer {} at {:.3f} s: {}", node.name(), t_s, line.text);
      if (std::ranges::find(info.warnings, warning) != info.warnings.end()) continue;
      info.warnings.push_back(warning);
      std::cerr << warning << '\n';
    }
  };
  const bool show_progress = isatty(STDERR_FILENO) != 0 && !options.verbose;
  const auto begun = std::chrono::steady_clock::now();
  double simulated_s = 0.0;
  std::vector<report::RunRecord> records;
  for (const config::RunSettings& run : scenario->runs) {
    if (show_progress) std::cerr << "\rrun " << records.size() + 1 << " of " << scenario->runs.size() << std::flush;
    std::optional<sim::Captures> captures;
    if (!options.captures.empty()) {
      captures.emplace(options.captures, *scenario, options.scenario);
      if (scenario->runs.size() > 1) captures->folder /= fmt::format("run-{:03}", records.size() + 1);
      std::error_code error;
      std::filesystem::create_directories(captures->folder, error);
      if (error)
        return failed({"error: can't make the folder " + captures->folder.string() + ": " + error.message(), 3});
    }
    auto record = sim::simulated_run(run, **shared, observer, key_observer, captures ? &*captures : nullptr);
    if (!record) return failed(record.error());
    simulated_s += run.duration_s;
    records.push_back(std::move(*record));
  }
  if (show_progress) std::cerr << "\r\033[K";

  const auto out = options.out.empty() ? std::filesystem::path("out") / scenario->name : options.out;
  const int code = print_report(info, records, scenario->expectations, out, options.json);
  if (code > 1 || options.json) return code;
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  std::cout << fmt::format("{:.0f} s of {} in {:.2f} s, reports included: {:.0f} times real time; {}\n", simulated_s,
                           counted(records.size(), "run"), took_s, simulated_s / took_s,
                           (out / "report.html").string());
  return code;
}

}  // namespace peerd
