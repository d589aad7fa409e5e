#include "peerd/cli/lab/sim_command.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <mutex>
#include <set>
#include <thread>

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include "peerd/cli/lab/scenario_options.hpp"
#include "peerd/cli/shell/print.hpp"
#include "peerd/cli/shell/problems.hpp"
#include "peerd/input/console/progress.hpp"
#include "peerd/input/console/stop_signals.hpp"
#include "peerd/input/printable.hpp"
#include "peerd/input/text_file.hpp"
#include "peerd/lab/baselines/baseline_run.hpp"
#include "peerd/lab/cluster/result_bytes.hpp"
#include "peerd/lab/cluster/run_missing.hpp"
#include "peerd/lab/cluster/scenario_work.hpp"
#include "peerd/lab/live/measuring.hpp"
#include "peerd/peer/config/resolve.hpp"
#include "peerd/peer/node/describe.hpp"
#include "peerd/peer/record/rerun.hpp"

namespace peerd {
namespace {

double session_s(HostTime now, const PeerNode& node) {
  return to_seconds(now.time_since_epoch() - node.start()->time_since_epoch());
}

// The runs of a scenario as the items of a work.
Result<cluster::Work> sim_work(const ScenarioOptions& options, const config::Scenario& scenario,
                               const SharedWorld& shared) {
  std::vector<std::filesystem::path> files{options.scenario};
  files.insert(files.end(), options.configs.begin(), options.configs.end());
  std::vector<std::string> others = options.sets;
  others.insert(others.end(), {options.samples, options.captures.string()});
  return cluster::scenario_work(options.cluster, files, others, scenario, shared);
}

// The command line of a task of that work, but for its items.
std::vector<std::string> sim_task(const ScenarioOptions& options, const std::filesystem::path& out) {
  std::vector<std::string> command{options.cluster.program.string(), "sim", options.scenario.string()};
  for (const auto& file : options.configs) command.push_back("--config=" + file.string());
  for (const std::string& set : options.sets) command.push_back("--set=" + set);
  if (options.seed) command.push_back(fmt::format("--seed={}", *options.seed));
  if (options.repeat) command.push_back(fmt::format("--repeat={}", *options.repeat));
  if (!options.captures.empty()) command.push_back("--capture=" + options.captures.string());
  command.push_back("--samples=" + options.samples);
  command.push_back("--out=" + std::filesystem::absolute(out).string());
  command.push_back("--task");
  return command;
}

// Runs all runs of a scenario until a signal stops it: one after the other, or several at once, each by a thread with a
// world of its own. Their order is that of the scenario in any case, and so are all numbers.
class SimCommand {
 public:
  SimCommand(const ScenarioOptions& options, const config::Scenario& scenario, const SharedWorld& shared,
             measure::ScenarioInfo& info, const StopSignals& signals)
      : options_(options),
        scenario_(scenario),
        shared_(shared),
        info_(info),
        signals_(signals),
        display_(isatty(STDERR_FILENO) != 0 && !options.verbose) {
    for (const config::RunSettings& run : scenario.runs) durations_s_.push_back(run.duration_s);
    printed_.insert(info.warnings.begin(), info.warnings.end());
    done_.resize(scenario.runs.size());
    warnings_.resize(scenario.runs.size());
  }

  Result<std::vector<measure::RunRecord>> run_all() {
    const std::size_t jobs = std::min<std::size_t>(jobs_of(options_), scenario_.runs.size());
    std::vector<std::unique_ptr<const SharedWorld>> worlds;
    for (std::size_t i = 1; i < jobs; ++i) {
      auto world = share_world(scenario_.world, scenario_.reading, scenario_.runs);
      if (!world) return std::unexpected(world.error());
      worlds.push_back(*std::move(world));
    }
    {
      std::vector<std::jthread> threads;
      for (const auto& world : worlds) threads.emplace_back([this, &world] { run_some(*world); });
      run_some(shared_);
    }
    display_.clear();
    return gather();
  }

  // The same by other processes, here or on a cluster.
  Result<std::vector<measure::RunRecord>> run_elsewhere(const std::filesystem::path& out) {
    auto work = sim_work(options_, scenario_, shared_);
    if (!work) return std::unexpected(work.error());
    const auto folder = cluster::WorkFolder::take(out / cluster::kWorkFolder, *std::move(work));
    if (!folder) return std::unexpected(folder.error());
    const cluster::Running running{.options = options_.cluster,
                                   .processes = jobs_of(options_),
                                   .name = "peerd-" + scenario_.name,
                                   .unit = "run",
                                   .command = sim_task(options_, out)};
    const auto taken = cluster::run_and_take(
        *folder, running, signals_, [&](std::size_t run, std::string_view bytes) -> std::expected<void, std::string> {
          auto result = cluster::run_result_from(bytes);
          if (!result) return std::unexpected(result.error());
          done_[run] = std::move(result->record);
          for (const std::string& warning : result->warnings) warn(run, warning);
          return {};
        });
    if (!taken) return std::unexpected(taken.error());
    return gather();
  }

  // This process is such another one: it leaves the results of its runs in the folder. Returns the exit code.
  int run_task(const std::filesystem::path& out) {
    auto work = sim_work(options_, scenario_, shared_);
    if (!work) return failed(work.error());
    const auto folder = cluster::WorkFolder::join(out / cluster::kWorkFolder, *std::move(work));
    if (!folder) return failed(folder.error());
    const auto done = cluster::run_items(*folder, options_.cluster.items, signals_,
                                         [&](std::size_t run) -> Result<std::optional<std::string>> {
                                           auto record = run_one(run, shared_);
                                           if (!record) return std::unexpected(record.error());
                                           if (record->stopped) return std::nullopt;
                                           return cluster::to_bytes({*std::move(record), warnings_[run]});
                                         });
    if (!done) return failed(done.error());
    return 0;
  }

 private:
  static std::size_t jobs_of(const ScenarioOptions& options) {
    return options.jobs > 0 ? options.jobs : std::max(1u, std::thread::hardware_concurrency());
  }

  // Takes one run after the other that no thread has taken.
  void run_some(const SharedWorld& shared) {
    for (std::size_t run = next_++; run < done_.size() && signals_.signal() == 0; run = next_++) {
      done_[run] = run_one(run, shared);
      if (!*done_[run]) next_ = done_.size();
    }
  }

  // The records as far as there is no gap. The first error ends all.
  Result<std::vector<measure::RunRecord>> gather() {
    for (std::size_t run = 0; run < done_.size(); ++run) {
      for (const std::string& warning : warnings_[run]) {
        if (std::ranges::find(info_.warnings, warning) == info_.warnings.end()) info_.warnings.push_back(warning);
      }
      if (done_[run] && !*done_[run]) return std::unexpected(done_[run]->error());
    }
    for (std::optional<Result<measure::RunRecord>>& done : done_) {
      if (!done || ((*done)->stopped && (*done)->duration_s == 0.0)) break;
      records_.push_back(*std::move(*done));
      if (records_.back().stopped) break;
    }
    if (signals_.signal() != 0) note_stop();
    return std::move(records_);
  }

  Result<measure::RunRecord> run_one(std::size_t run, const SharedWorld& shared) {
    std::optional<sim::Captures> captures;
    if (!options_.captures.empty()) {
      captures.emplace(options_.captures, scenario_, options_.scenario);
      if (scenario_.runs.size() > 1) captures->folder /= fmt::format("run-{:03}", run + 1);
      std::error_code error;
      std::filesystem::create_directories(captures->folder, error);
      if (error) {
        return std::unexpected(InputError{
            "error: can't make the folder " + captures->folder.string() + ": " + error.message(), kSystemFailed});
      }
    }
    sim::Observer observer;
    if (options_.verbose) {
      observer = [&](HostTime now, const PeerNode& node, const replication::Output& output) {
        const auto line = describe(output, node.scene());
        if (line && node.start()) log(now, node, line->text);
      };
    }
    return baselines::run_of_any_system(
        scenario_.runs[run], shared, observer,
        [&](HostTime now, const PeerNode& node, const LogLine& line, bool done) {
          on_action(run, now, node, line, done);
        },
        captures ? &*captures : nullptr, measuring_of(scenario_, run, info_.csv_rows),
        [&](std::optional<double> run_s) { return go_on(run, run_s); });
  }

  static void log(HostTime now, const PeerNode& node, const std::string& text) {
    std::cerr << fmt::format("{:9.4f} s  peer {}: {}\n", session_s(now, node), node.peer().id().value, text);
  }

  // A key or an edit without its intended effect is a finding about the scenario. It is printed once and is part of the
  // report.
  void on_action(std::size_t run, HostTime now, const PeerNode& node, const LogLine& line, bool done) {
    if (options_.verbose) log(now, node, line.text);
    if (!done) warn(run, fmt::format("peer {} at {:.3f} s: {}", node.name(), session_s(now, node), line.text));
  }

  void warn(std::size_t run, const std::string& warning) {
    const std::lock_guard lock(terminal_);
    warnings_[run].push_back(warning);
    if (!printed_.insert(warning).second) return;
    display_.clear();
    std::cerr << warning << '\n';
  }

  bool go_on(std::size_t run, std::optional<double> run_s) {
    const std::lock_guard lock(terminal_);
    if (display_.due()) {
      const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count();
      display_.show(progress_line({.run = run, .runs_s = durations_s_, .run_s = run_s, .took_s = took_s}));
    }
    return signals_.signal() == 0;
  }

  // The line about runs that are left out is the first warning. A signal that comes in the last moment leaves nothing
  // out.
  void note_stop() {
    const std::size_t all = scenario_.runs.size();
    const bool cut = !records_.empty() && records_.back().stopped;
    if (!cut && records_.size() == all) return;
    info_.stopped = true;
    std::string text = "stopped by " + signals_.signal_name();
    if (cut) text += fmt::format(", in run {} at {:.3g} s", records_.size(), records_.back().duration_s);
    if (const std::size_t rest = all - records_.size(); rest > 0) {
      text += fmt::format("; {} of {} {} not in here", rest, all == 1 ? "1 run" : fmt::format("{} runs", all),
                          rest == 1 ? "is" : "are");
    }
    info_.warnings.insert(info_.warnings.begin(), text);
    std::cerr << text << '\n';
  }

  const ScenarioOptions& options_;
  const config::Scenario& scenario_;
  const SharedWorld& shared_;
  measure::ScenarioInfo& info_;
  const StopSignals& signals_;
  std::mutex terminal_;  // guards what is shown, and warnings_
  ProgressDisplay display_;
  std::set<std::string> printed_;
  std::vector<double> durations_s_;
  std::atomic<std::size_t> next_ = 0;                            // the first run that no thread has taken
  std::vector<std::optional<Result<measure::RunRecord>>> done_;  // by run; none: not run
  std::vector<std::vector<std::string>> warnings_;               // of each run
  std::vector<measure::RunRecord> records_;
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

// Keeps what peerd view makes the runs of once more.
Result<void> keep_rerun(const std::filesystem::path& out, const config::Scenario& scenario,
                        const std::filesystem::path& file, const SharedWorld& shared) {
  std::error_code error;
  std::filesystem::create_directories(out, error);
  if (error) {
    return std::unexpected(
        InputError{"error: can't make the folder " + out.string() + ": " + error.message(), kSystemFailed});
  }
  return write_text_file(out / record::kRerunFile, record::to_text(record::make_rerun(scenario, file, shared)));
}

}  // namespace

int run_sim(const ScenarioOptions& options) {
  const auto begun = std::chrono::steady_clock::now();
  StopSignals signals("stopped while the scenario and its world were read: nothing was run, nothing is written");
  const auto csv_rows = read_samples(options.samples);
  if (!csv_rows) return failed(csv_rows.error());
  const auto scenario = config::read_scenario({.file = options.scenario,
                                               .configs = options.configs,
                                               .sets = options.sets,
                                               .seed = options.seed,
                                               .repeat = options.repeat});
  if (!scenario) return failed(scenario.error());
  print_warnings(scenario->warnings);
  if (std::ranges::any_of(scenario->runs, [](const auto& run) { return run.via != config::Via::kNothing; })) {
    return failed({"error: network.via: servers stand between real peers alone: peerd scenario", kWrongUse});
  }
  const auto shared = share_world(scenario->world, scenario->reading, scenario->runs);
  if (!shared) return failed(shared.error());
  const Scene& scene = (*shared)->world.scene;
  print_warnings(config::settings_without_effect(scenario->runs.front(), scene));

  measure::ScenarioInfo info{scenario->name, "sim", scenario->seed, {}, scenario->repeat, command_line("sim", options)};
  info.csv_rows = *csv_rows;
  info.warnings = (*shared)->findings();
  print_warnings(info.warnings);

  signals.note_from_now_on("stopped at once by a second signal: the report is not complete");
  const auto out = options.out.empty() ? std::filesystem::path("out") / scenario->name : options.out;
  SimCommand command(options, *scenario, **shared, info, signals);
  if (!options.cluster.items.empty()) return command.run_task(out);
  const auto records =
      options.cluster.runner == cluster::Runner::kHere ? command.run_all() : command.run_elsewhere(out);
  if (!records) return failed(records.error());
  if (records->empty()) {
    std::cerr << "the motions of no run had begun: nothing is written\n";
    return signals.exit_code();
  }
  // Of a part of the runs nothing was expected.
  const std::vector<config::Expectation> expected =
      info.stopped ? std::vector<config::Expectation>{} : scenario->expectations;
  if (const auto kept = keep_rerun(out, *scenario, options.scenario, **shared); !kept) return failed(kept.error());
  const int code = print_report(info, *records, expected, out, options.json);
  if (code <= 1 && !options.json) {
    double simulated_s = 0.0;
    for (const measure::RunRecord& record : *records) simulated_s += record.duration_s;
    const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    std::cout << fmt::format("{:.0f} s of {} in {:.2f} s, reports included: {:.0f} times real time; {}\n", simulated_s,
                             counted(records->size(), "run"), took_s, simulated_s / took_s,
                             (out / "report.html").string());
  }
  return signals.signal() != 0 && code <= 1 ? signals.exit_code() : code;
}

}  // namespace peerd
