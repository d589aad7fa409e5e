#include "peerd/cli/lab/chaos_command.hpp"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <map>
#include <thread>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "peerd/cli/shell/print.hpp"
#include "peerd/input/console/stop_signals.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/input/number.hpp"
#include "peerd/input/printable.hpp"
#include "peerd/lab/chaos/chaos_run.hpp"
#include "peerd/lab/chaos/shrink.hpp"
#include "peerd/lab/cluster/result_bytes.hpp"
#include "peerd/lab/cluster/run_missing.hpp"
#include "peerd/lab/cluster/scenario_work.hpp"
#include "peerd/lab/cluster/work_folder.hpp"
#include "peerd/peer/config/scenario.hpp"

namespace peerd {
namespace {

constexpr std::size_t kShrinkRunsMax = 120;
constexpr std::size_t kShrunkMax = 3;  // seeds
static_assert(kChaosSecondsMin == chaos::ChaosLimits::kSecondsMin);

using Simulate = std::function<chaos::ChaosReport(const chaos::ChaosPlan&)>;

struct Seeds {
  std::uint64_t first = 0, last = 0;
};

std::optional<std::uint64_t> read_seed(const std::string& text) {
  const auto seed = parse_whole_number(text, 0, config::kSeedMax);
  return seed ? std::optional(static_cast<std::uint64_t>(*seed)) : std::nullopt;
}

std::optional<Seeds> read_seeds(const ChaosOptions& options) {
  const std::size_t dots = options.seeds.find("..");
  const auto first = read_seed(options.seeds.substr(0, dots));
  if (!first) return std::nullopt;
  if (dots == std::string::npos) return Seeds{*first, *first + options.count - 1};
  const auto last = read_seed(options.seeds.substr(dots + 2));
  if (!last || *last < *first || options.count != 1) return std::nullopt;
  return Seeds{*first, *last};
}

nlohmann::ordered_json as_json(const chaos::ChaosReport& report) {
  nlohmann::ordered_json line{{"seed", report.seed},
                              {"trace", fmt::format("{:016x}", report.trace_hash)},
                              {"peers", report.peers},
                              {"lives", report.lives},
                              {"faults", report.faults},
                              {"edits", report.edits},
                              {"operations", report.operations},
                              {"held", report.held},
                              {"datagrams", report.datagrams},
                              {"damaged", report.damaged}};
  if (report.one_world_after_s) line["one_world_after_s"] = *report.one_world_after_s;
  line["violations"] = report.violations;
  line["branches"] = report.branches;
  return line;
}

// The seeds as the items of a work.
Result<cluster::Work> chaos_work(const ChaosOptions& options, const Seeds& seeds) {
  auto work = cluster::work_of_this_program(options.cluster, "chaos");
  if (!work) return work;
  const nlohmann::ordered_json peers = options.peers ? nlohmann::ordered_json(*options.peers) : nullptr;
  work->settings = cluster::hash_of({seeds.first, seeds.last, options.seconds, peers, options.without});
  for (std::uint64_t seed = seeds.first;; ++seed) {
    work->items.push_back(fmt::format("seed-{}", seed));
    if (seed == seeds.last) return work;
  }
}

std::filesystem::path work_folder_of(const ChaosOptions& options) {
  return (options.out.empty() ? std::filesystem::path("out") / "chaos" : options.out) / cluster::kWorkFolder;
}

// The command line of a task of that work, but for its items.
std::vector<std::string> chaos_task(const ChaosOptions& options) {
  std::vector<std::string> command{options.cluster.program.string(), "sim", "--chaos=" + options.seeds};
  if (options.count != 1) command.push_back(fmt::format("--count={}", options.count));
  command.push_back(fmt::format("--chaos-seconds={}", options.seconds));
  if (options.peers) command.push_back(fmt::format("--chaos-peers={}", *options.peers));
  if (!options.without.empty()) command.push_back("--chaos-without=" + options.without);
  command.push_back("--out=" + std::filesystem::absolute(work_folder_of(options).parent_path()).string());
  command.push_back("--task");
  return command;
}

// Runs the seeds one after the other, until a signal stops it.
class ChaosCommand {
 public:
  ChaosCommand(const ChaosOptions& options, const chaos::ChaosLimits& limits, const Simulate& simulate,
               const StopSignals& signals)
      : options_(options), limits_(limits), simulate_(simulate), signals_(signals) {}

  // Has other processes run the seeds first, here or on a cluster.
  int run_elsewhere(const Seeds& seeds) {
    auto work = chaos_work(options_, seeds);
    if (!work) return failed(work.error());
    const auto folder = cluster::WorkFolder::take(work_folder_of(options_), *std::move(work));
    if (!folder) return failed(folder.error());
    const cluster::Running running{
        .options = options_.cluster,
        .processes = options_.jobs > 0 ? options_.jobs : std::max(1u, std::thread::hardware_concurrency()),
        .name = "peerd-chaos",
        .unit = "seed",
        .command = chaos_task(options_)};
    const auto taken = cluster::run_and_take(
        *folder, running, signals_, [&](std::size_t item, std::string_view bytes) -> std::expected<void, std::string> {
          auto report = cluster::chaos_report_from(bytes);
          if (!report) return std::unexpected(report.error());
          known_[seeds.first + item] = *std::move(report);
          return {};
        });
    if (!taken) return failed(taken.error());
    return run(seeds);
  }

  // This process is such another one: it leaves the results of its seeds in the folder.
  int run_task(const Seeds& seeds) {
    auto work = chaos_work(options_, seeds);
    if (!work) return failed(work.error());
    const auto folder = cluster::WorkFolder::join(work_folder_of(options_), *std::move(work));
    if (!folder) return failed(folder.error());
    const auto done = cluster::run_items(
        *folder, options_.cluster.items, signals_, [&](std::size_t item) -> Result<std::optional<std::string>> {
          return cluster::to_bytes(simulate_(chaos::draw_plan(seeds.first + item, limits_)));
        });
    if (!done) return failed(done.error());
    return 0;
  }

  int run(const Seeds& seeds) {
    const auto begun = std::chrono::steady_clock::now();
    for (std::uint64_t seed = seeds.first; seed <= seeds.last && signals_.signal() == 0; ++seed) {
      run_one(seed);
      if (seed == seeds.last) break;  // the last of all numbers has no successor
    }
    const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    if (!options_.json) print_sum(took_s);
    if (signals_.signal() != 0) return signals_.exit_code();
    return failed_ > 0 ? 1 : 0;
  }

 private:
  void run_one(std::uint64_t seed) {
    const auto known = known_.find(seed);
    const chaos::ChaosReport report =
        known != known_.end() ? known->second : simulate_(chaos::draw_plan(seed, limits_));
    ++runs_;
    for (const auto& [branch, times] : report.branches) {
      if (times == 0) continue;
      taken_[branch].first += times;
      ++taken_[branch].second;
    }
    if (options_.json) {
      std::cout << json_line(as_json(report)) << '\n' << std::flush;
    } else {
      print(report);
    }
    if (report.one_world_after_s) latest_s_ = std::max(latest_s_, *report.one_world_after_s);
    if (report.violations.empty()) return;
    ++failed_;
    std::ostream& out = options_.json ? std::cerr : std::cout;
    for (const std::string& violation : report.violations) out << "  " << violation << '\n';
    out << "  again: peerd sim " << chaos::options_of(seed, limits_) << '\n' << std::flush;
    if (options_.shrinks && failed_ <= kShrunkMax) shrink(seed, out);
  }

  void shrink(std::uint64_t seed, std::ostream& out) {
    // After a signal no run fails, so that what has been found so far is printed.
    const auto fails = [&](const chaos::ChaosLimits& limits) {
      return signals_.signal() == 0 && !simulate_(chaos::draw_plan(seed, limits)).violations.empty();
    };
    const chaos::Shrunk shrunk = chaos::shrink(seed, limits_, fails, kShrinkRunsMax);
    const chaos::ChaosPlan plan = chaos::draw_plan(seed, shrunk.limits);
    out << fmt::format("  smaller, with {}, {} and {} ({}): peerd sim {}", counted(plan.peers.size(), "peer"),
                       counted(plan.faults.size(), "fault"), counted(plan.edits.size(), "edit"),
                       counted(shrunk.runs, "run"), chaos::options_of(seed, shrunk.limits))
        << '\n'
        << std::flush;
  }

  static void print(const chaos::ChaosReport& r) {
    const std::string one = r.one_world_after_s ? fmt::format("one world {:.2f} s after healing", *r.one_world_after_s)
                                                : std::string("not one world");
    std::cout << fmt::format(
                     "seed {}: {}, trace {:016x}, {} peers in {} lives, {} faults, {} of {} operations held, {} "
                     "datagrams, {} damaged, {}",
                     r.seed, r.violations.empty() ? "good" : "VIOLATED", r.trace_hash, r.peers, r.lives, r.faults,
                     r.held, r.operations, r.datagrams, r.damaged, one)
              << '\n'
              << std::flush;
  }

  void print_sum(double took_s) const {
    if (runs_ > 1) {
      std::cout << fmt::format("{:<50} {:>12} {:>8}\n", "branch", "taken", "seeds");
      for (const auto& [branch, times] : taken_) {
        std::cout << fmt::format("{:<50} {:>12} {:>8}\n", branch, times.first, times.second);
      }
    }
    std::cout << fmt::format(
        "{} of {} seeds with a violation; one world {:.2f} s after healing at the latest; {:.1f} s, {:.2f} s a seed\n",
        failed_, runs_, latest_s_, took_s, took_s / static_cast<double>(std::max<std::uint64_t>(runs_, 1)));
  }

  const ChaosOptions& options_;
  const chaos::ChaosLimits& limits_;
  const Simulate& simulate_;
  const StopSignals& signals_;
  std::uint64_t runs_ = 0, failed_ = 0;
  double latest_s_ = 0.0;
  std::map<std::uint64_t, chaos::ChaosReport> known_;                     // by seed: what other processes have found
  std::map<std::string, std::pair<std::uint64_t, std::uint64_t>> taken_;  // times, and seeds
};

}  // namespace

int run_chaos_seeds(const ChaosOptions& options) { return run_chaos_seeds(options, chaos::run_chaos); }

int run_chaos_seeds(const ChaosOptions& options, const Simulate& simulate) {
  StopSignals signals("stopped before the first seed");
  const auto seeds = read_seeds(options);
  if (!seeds)
    return failed({"error: --chaos " + options.seeds + ": write a seed, or FIRST..LAST without --count", kWrongUse});
  chaos::ChaosLimits limits;
  limits.seconds = options.seconds;
  limits.peers = options.peers;
  if (!chaos::read_without(options.without, limits)) {
    return failed({"error: --chaos-without " + options.without + ": write a list such as f3,e7,e10-20", kWrongUse});
  }
  signals.note_from_now_on("stopped at once by a second signal");
  ChaosCommand command(options, limits, simulate, signals);
  if (!options.cluster.items.empty()) return command.run_task(*seeds);
  return options.cluster.runner == cluster::Runner::kHere ? command.run(*seeds) : command.run_elsewhere(*seeds);
}

}  // namespace peerd
