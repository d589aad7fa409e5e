#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "peerd/lab/chaos/plan.hpp"

namespace peerd::chaos {

struct ChaosReport {
  std::uint64_t seed = 0;
  std::vector<std::string> violations;  // the first ones, each with its time
  std::uint64_t trace_hash = 0;         // of all datagrams and edits, in their order
  std::size_t peers = 0, lives = 0, faults = 0, edits = 0, operations = 0, held = 0;
  std::uint64_t datagrams = 0, damaged = 0;
  std::optional<double> one_world_after_s;        // after the network healed; none: never
  std::map<std::string, std::uint64_t> branches;  // how often each rare branch was taken
};

// Runs a plan: a function of it.
[[nodiscard]] ChaosReport run_chaos(const ChaosPlan& plan);

}  // namespace peerd::chaos
