#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "peerd/lab/cluster/cluster_options.hpp"

namespace peerd::chaos {
struct ChaosPlan;
struct ChaosReport;
}  // namespace peerd::chaos

namespace peerd {

// The shortest run of `peerd sim --chaos` [s]: behind the healing, peers have the time to do what they must.
inline constexpr double kChaosSecondsMin = 22.0;

// The options of `peerd sim --chaos`.
struct ChaosOptions {
  std::string seeds;  // SEED or FIRST..LAST; empty: no chaos
  std::uint64_t count = 1;
  double seconds = 60.0;
  std::optional<std::uint64_t> peers;
  std::string without;
  bool shrinks = true;
  bool json = false;
  cluster::ClusterOptions cluster{};  // where the seeds are run
  std::uint32_t jobs = 0;             // with Runner::kProcesses: how many at once; 0: as many as there are processors
  std::filesystem::path out;          // where other processes leave their results; empty: out/chaos
};

// `peerd sim --chaos`: peers that edit a world while everything fails that can, one run for each seed. A violation of
// what must hold is a finding.
[[nodiscard]] int run_chaos_seeds(const ChaosOptions& options);
// The same with another simulation.
[[nodiscard]] int run_chaos_seeds(const ChaosOptions& options,
                                  const std::function<chaos::ChaosReport(const chaos::ChaosPlan&)>& simulate);

}  // namespace peerd
