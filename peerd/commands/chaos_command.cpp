#include "peerd/commands/chaos_command.hpp"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <map>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "peerd/chaos/chaos_run.hpp"
#include "peerd/chaos/shrink.hpp"
#include "peerd/command_line/stop_signals.hpp"
#include "peerd/commands/print.hpp"
#include "peerd/config/scenario.hpp"
#include "peerd/input/number.hpp"

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

// Runs the seeds one after the other, until a signal stops it.
class ChaosCommand {
 public:
  ChaosCommand(const ChaosOptions& options, const chaos::ChaosLimits& limits, const Simulate& simulate,
               const StopSignals& signals)
      : options_(options), limits_(limits), simulate_(simulate), signals_(signals) {}

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
    const chaos::ChaosReport report = simulate_(chaos::draw_plan(seed, limits_));
    ++runs_;
    for (const auto& [branch, times] : report.branches) {
      if (times == 0) continue;
      taken_[branch].first += times;
      ++taken_[branch].second;
    }
    if (options_.json) {
      std::cout << as_json(report).dump() << '\n' << std::flush;
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
  std::map<std::string, std::pair<std::uint64_t, std::uint64_t>> taken_;  // times, and seeds
};

}  // namespace

int run_chaos_seeds(const ChaosOptions& options) { return run_chaos_seeds(options, chaos::run_chaos); }

int run_chaos_seeds(const ChaosOptions& options, const Simulate& simulate) {
  StopSignals signals("stopped before the first seed");
  const auto seeds = read_seeds(options);
  if (!seeds) return failed({"error: --chaos " + options.seeds + ": write a seed, or FIRST..LAST without --count", 2});
  chaos::ChaosLimits limits;
  limits.seconds = options.seconds;
  limits.peers = options.peers;
  if (!chaos::read_without(options.without, limits)) {
    return failed({"error: --chaos-without " + options.without + ": write a list such as f3,e7,e10-20", 2});
  }
  signals.note_from_now_on("stopped at once by a second signal");
  return ChaosCommand(options, limits, simulate, signals).run(*seeds);
}

}  // namespace peerd
