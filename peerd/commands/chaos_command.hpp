#pragma once
#include <cstdint>
#include <optional>
#include <string>

namespace peerd {

// The options of `peerd sim --chaos`.
struct ChaosOptions {
  std::string seeds;  // SEED or FIRST..LAST; empty: no chaos
  std::uint64_t count = 1;
  double seconds = 60.0;
  std::optional<std::uint64_t> peers;
  std::string without;
  bool shrinks = true;
  bool json = false;
};

// `peerd sim --chaos`: peers that edit a world while everything fails that can, one run for each seed. A violation of
// what must hold is a finding.
[[nodiscard]] int run_chaos_seeds(const ChaosOptions& options);

}  // namespace peerd
