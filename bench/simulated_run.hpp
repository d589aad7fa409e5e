#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "replication/settings/policy/publish_policy.hpp"

namespace peerd::bench {

// A run of configs/scenarios/SCENARIO.toml with configs/CONFIG.toml on the simulated network. The settings must leave
// one run of what the scenario sweeps.
struct SimulatedRun {
  std::string scenario, config;
  double latency_ms = 0.0, duration_s = 0.0;
  std::vector<std::string> sets = {};  // KEY=VALUE
};
// The functions throw std::runtime_error where there is no such run.

// The publish policy of configs/CONFIG.toml, as it is in any scenario.
[[nodiscard]] replication::PublishPolicy policy_in(const std::string& config,
                                                   const std::vector<std::string>& sets = {});
// Its part of summary.json.
[[nodiscard]] nlohmann::ordered_json summary_of(const SimulatedRun& run);

inline constexpr double kUdpHeader_bytes = 28.0;  // .. and IPv4's

// An outcome holds what a run cost, and the errors of all peers.
struct Outcome {
  double bytes_per_s = 0.0;           // UDP payload of all datagrams of all peers
  double bytes_with_udp_per_s = 0.0;  // .. and 28 bytes of IPv4 and UDP header each
  double update_bytes_per_s = 0.0;  // .. of those, updates, and all headers of a datagram for each instant's of a peer
  double ghost_error_m = 0.0;       // mean of all objects at all observers, against the truth at that instant
  double updates_per_s = 0.0;       // of all objects
  std::string wrong;                // why the run proves nothing; empty if it does
};
[[nodiscard]] Outcome simulate(const SimulatedRun& run);

// An approach's error against its bytes: one point for each value of what trades one for the other, in that order.
using Tradeoff = std::span<const Outcome>;
// Bytes a second (a member of Outcome) that the curve takes for an error of at most that; none where it never gets
// there. Straight between points, as logarithms.
[[nodiscard]] std::optional<double> bytes_for(Tradeoff curve, double error_m, double Outcome::*bytes);

// The thresholds [m] are what a curve is swept over: wanted_error_m of configs/best.toml (with its error threshold,
// which is never less than 1 m), error_threshold_m of dead reckonings that know nothing else. DIS's own, 1 m, is among
// them.
[[nodiscard]] std::vector<double> thresholds_m(bool quick);
[[nodiscard]] std::vector<std::string> best_at(double threshold_m);
[[nodiscard]] std::vector<std::string> dead_reckoning_at(double threshold_m);

}  // namespace peerd::bench
