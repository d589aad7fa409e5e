// Question: what does it cost, in bytes, to be wrong by how much; and what do others' approaches cost on the same
// motion?
//
// replication_bench [--quick] [--out DIR] [--commit NAME]: crowd, traffic, flock and orbit at 5, 100, 200 and 500 ms on
// the simulated network. Each approach is a curve, swept over what trades bytes for error: configs/best.toml over
// wanted_error_m, the dead reckonings of configs/baselines over error_threshold_m; server and lockstep are points.
// error: mean ghost error of all objects at all observers, against the truth at that instant.
// Bytes: UDP payload of all datagrams, hellos included, of all peers, a second. Then best.toml without one mechanism at
// a time, at 200 ms.
//
// Writes replication-curves.csv. Exit code 1: a run in which peers don't agree on a decided outcome, or in which nobody
// saw anything.
#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "figures.hpp"
#include "simulated_run.hpp"

namespace peerd::bench {
namespace {

struct Curve {
  std::string name;
  std::vector<Outcome> points;
};

class Bench {
 public:
  explicit Bench(const Options& options) : options_(options) {}

  int run() {
    const std::vector<std::string> scenarios = options_.quick
                                                   ? std::vector<std::string>{"orbit"}
                                                   : std::vector<std::string>{"crowd", "traffic", "flock", "orbit"};
    const std::vector<double> latencies_ms =
        options_.quick ? std::vector<double>{200} : std::vector<double>{5, 100, 200, 500};
    for (const std::string& scenario : scenarios) {
      for (const double latency_ms : latencies_ms) compare(scenario, latency_ms);
      without_one(scenario, 200.0);
    }
    const bool written = write_figures(options_, figures_) && write_beside(options_, "replication-curves.csv", csv_);
    return written && sound_ ? 0 : 1;
  }

 private:
  Outcome simulate_one(const std::string& scenario, const std::string& config, double latency_ms,
                       std::vector<std::string> sets) {
    if (scenario == "traffic") {
      sets.push_back("decisions.policy=expected-error");
    }
    Outcome outcome = simulate({scenario, config, latency_ms, options_.quick ? 3.0 : 12.0, std::move(sets)});
    if (!outcome.wrong.empty()) {
      std::printf("error: %s on %s at %g ms: %s\n", config.c_str(), scenario.c_str(), latency_ms,
                  outcome.wrong.c_str());
      sound_ = false;
    }
    return outcome;
  }

  Curve sweep(const std::string& scenario, const std::string& name, const std::string& config, double latency_ms,
              const std::vector<std::vector<std::string>>& settings) {
    Curve curve{name, {}};
    for (const auto& sets : settings) {
      const Outcome& o = curve.points.emplace_back(simulate_one(scenario, config, latency_ms, sets));
      char row[300];
      std::snprintf(row, sizeof row, "%s,%g,%s,\"%s\",%.0f,%.6f,%.6f,%.4f\n", scenario.c_str(), latency_ms,
                    name.c_str(), sets.empty() ? "" : sets.front().c_str(), o.bytes_per_s, o.ghost_error_m,
                    o.view_difference_m, o.updates_per_object_s);
      csv_ += row;
      std::printf("%s", row);
      std::fflush(stdout);
    }
    return curve;
  }

  [[nodiscard]] std::vector<std::vector<std::string>> by_threshold() const {
    std::vector<std::vector<std::string>> all;
    for (const double m : thresholds_m(options_.quick)) all.push_back(dead_reckoning_at(m));
    return all;
  }
  [[nodiscard]] std::vector<std::vector<std::string>> by_wanted_error(
      const std::vector<std::string>& besides = {}) const {
    std::vector<std::vector<std::string>> all;
    for (const double m : thresholds_m(options_.quick)) {
      all.push_back(best_at(m));
      all.back().insert(all.back().end(), besides.begin(), besides.end());
    }
    return all;
  }

  void compare(const std::string& scenario, double latency_ms) {
    std::vector<Curve> curves{sweep(scenario, "best", "best", latency_ms, by_wanted_error())};
    for (const char* name : {"dis", "npsnet", "position-history", "thesis"}) {
      curves.push_back(sweep(scenario, name, "baselines/" + std::string(name), latency_ms, by_threshold()));
    }
    const std::string at = scenario + "." + std::to_string(static_cast<int>(latency_ms)) + "ms.";
    for (std::size_t i = 1; i < curves.size(); ++i) {
      std::optional<double> least;
      std::size_t beyond = 0;
      for (const Outcome& p : curves[i].points) {
        const auto bytes = bytes_for(curves.front().points, p.ghost_error_m, &Outcome::bytes_per_s);
        if (bytes) least = std::min(least.value_or(1e9), p.bytes_per_s / *bytes);
        beyond += !bytes;
      }
      figures_.push_back({at + curves[i].name + ".least_bytes_over_best", least.value_or(0.0), "ratio", "1", least});
      figures_.push_back({at + curves[i].name + ".points_beyond_best", static_cast<double>(beyond), "points", "0", {}});
    }
    const std::vector<double> thresholds = thresholds_m(options_.quick);
    const Outcome& dis =
        curves[1].points[static_cast<std::size_t>(std::ranges::find(thresholds, 1.0) - thresholds.begin())];
    const auto bytes = bytes_for(curves.front().points, dis.ghost_error_m, &Outcome::bytes_per_s);
    figures_.push_back({at + "dis_1m.bytes_over_best", bytes ? dis.bytes_per_s / *bytes : 0.0, "ratio", "2", {}});
    // DIS's own standard sends an entity state PDU for each update; the size is without the UDP header.
    constexpr double kEntityState_bytes = 144.0;
    figures_.push_back({at + "dis_1m_pdus.bytes_over_best",
                        bytes ? dis.updates_per_s * kEntityState_bytes / *bytes : 0.0,
                        "ratio",
                        "2",
                        {}});
    for (const char* name : {"server", "server-bare", "lockstep"}) {
      sweep(scenario, name, "baselines/" + std::string(name), latency_ms, {{}});
      // Dead reckoning whose users' input waits as long as the network takes, as lockstep's and the bare server's does.
      if (std::string(name) == "lockstep") {
        sweep(scenario, "best, input delayed", "best", latency_ms,
              {{"replication.display_delay_ms=" + std::to_string(latency_ms + 17.0), "replication.delay_own=true"}});
      }
    }
  }

  void without_one(const std::string& scenario, double latency_ms) {
    struct Without {
      const char* name;
      std::vector<std::string> sets;
    };
    const Without kinds[] = {
        {"best", {}},
        {"without model choice", {"replication.model=order"}},
        {"without surface error", {"replication.surface_error=false", "replication.angle_threshold_deg=3"}},
        {"without prediction of collisions", {"replication.approach=dr"}},
        {"proximity by spheres", {"replication.proximity=spheres"}},
        {"nothing goes along", {"replication.piggyback_fraction=1"}}};
    for (const Without& kind : kinds) sweep(scenario, kind.name, "best", latency_ms, by_wanted_error(kind.sets));
  }

  Options options_;
  std::vector<Figure> figures_;
  std::string csv_ =
      "scenario,latency_ms,approach,set,bytes_per_s,ghost_error_m,view_difference_m,updates_per_object_s\n";
  bool sound_ = true;
};

}  // namespace
}  // namespace peerd::bench

int main(int argc, char** argv) {
  using namespace peerd::bench;
  return run_main(argc, argv, [](const Options& options) { return Bench(options).run(); });
}
