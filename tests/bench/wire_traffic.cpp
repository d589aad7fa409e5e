#include "wire_traffic.hpp"

#include <algorithm>
#include <stdexcept>

#include "simulated_run.hpp"

namespace peerd::bench {
namespace {

constexpr double kEntityState_bytes = 144.0 + 28.0;  // IEEE 1278.1, without articulations, in UDP over IPv4
constexpr double kAtMostOfDis = 1.0 / 8.0, kAtMostOfInterest = 1.3;

Outcome sound(const SimulatedRun& run) {
  Outcome outcome = simulate(run);
  if (!outcome.wrong.empty()) throw std::runtime_error(run.scenario + ": " + outcome.wrong);
  return outcome;
}

std::string at(double latency_ms) { return "." + std::to_string(static_cast<int>(latency_ms)) + "ms"; }

// The worst of them comes first.
std::vector<Figure> with_worst(std::vector<Figure> each, const std::string& name) {
  Figure worst = *std::ranges::max_element(each, {}, &Figure::value);
  worst.name = name;
  each.insert(each.begin(), worst);
  return each;
}

double bytes_over_dis(const std::string& scenario, double latency_ms, const Options& options) {
  const double duration_s = options.quick ? 3.0 : 12.0;
  const auto run = [&](const char* config, std::vector<std::string> sets) {
    if (scenario == "traffic") sets.push_back("decisions.policy=expected-error");
    return sound({scenario, config, latency_ms, duration_s, std::move(sets)});
  };
  const Outcome dis = run("baselines/dis", dead_reckoning_at(1.0));
  std::vector<Outcome> ours;
  for (const double m : thresholds_m(options.quick)) ours.push_back(run("best", best_at(m)));
  const auto bytes = bytes_for(ours, dis.ghost_error_m, &Outcome::bytes_with_udp_per_s);
  if (!bytes) throw std::runtime_error(scenario + ": never as accurate as DIS");
  return *bytes / (kEntityState_bytes * dis.updates_per_s);
}

double received_over_interest(double latency_ms, const Options& options) {
  const auto summary = summary_of({"flock-regions", "best", latency_ms, options.quick ? 5.0 : 60.0});
  const auto& interest = summary.at("interest");
  if (interest.at("missing_samples") != 0) throw std::runtime_error("flock-regions: an object is missing");
  return interest.at("received_over_interest").get<double>();
}

}  // namespace

std::vector<Figure> wire_traffic(const Options& options) {
  const std::vector<double> latencies_ms =
      options.quick ? std::vector<double>{100} : std::vector<double>{5, 100, 200, 500};
  std::vector<Figure> dis, flock;
  for (const double ms : latencies_ms) {
    for (const char* scenario : {"crowd", "traffic"}) {
      const double ratio = bytes_over_dis(scenario, ms, options);
      dis.push_back({"bytes_over_dis." + std::string(scenario) + at(ms), ratio, "x", "<= 0.125", ratio / kAtMostOfDis,
                     ratio, ratio});
    }
    const double ratio = received_over_interest(ms, options);
    flock.push_back(
        {"flock_received_over_aoi" + at(ms), ratio, "x", "<= 1.3", ratio / kAtMostOfInterest, ratio, ratio});
  }
  std::vector<Figure> all = with_worst(std::move(dis), "bytes_over_dis");
  std::ranges::copy(with_worst(std::move(flock), "flock_received_over_aoi"), std::back_inserter(all));
  return all;
}

}  // namespace peerd::bench
