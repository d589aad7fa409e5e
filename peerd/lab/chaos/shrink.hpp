#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>

#include "peerd/lab/chaos/plan.hpp"

namespace peerd::chaos {

struct Shrunk {
  ChaosLimits limits;
  std::size_t runs = 0;  // that it took
};

// Looks for a smaller run of that seed that still fails: a shorter one, with fewer peers, faults and edits. It asks
// `fails` at most `runs_max` times; what is left then need not be the smallest. The run with `limits` fails.
[[nodiscard]] Shrunk shrink(std::uint64_t seed, const ChaosLimits& limits,
                            const std::function<bool(const ChaosLimits&)>& fails, std::size_t runs_max);

}  // namespace peerd::chaos
