#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "peerd/lab/cluster/cluster_options.hpp"

namespace peerd {

// The options that `peerd sim` and `peerd scenario` share.
struct ScenarioOptions {
  std::filesystem::path scenario;
  std::vector<std::filesystem::path> configs;
  std::vector<std::string> sets;
  std::optional<std::uint64_t> seed;
  std::optional<std::uint32_t> repeat;  // number of seeds
  std::filesystem::path out;            // empty: out/NAME
  std::string interface;                // real runs only
  bool netem = false;                   // real runs only: over the scenario's network, made by the kernel's netem
  bool tcpdump = false;                 // with netem only: record each peer's interface, for tcpdump or Wireshark
  std::filesystem::path captures;       // simulated runs only: a folder for each peer's capture; empty: none
  std::string samples = "40000";        // --samples: all, none, or the most rows of errors.csv and of traffic.csv
  std::uint32_t jobs = 1;               // simulated runs only: how many at once; 0: as many as there are processors
  cluster::ClusterOptions cluster{};    // simulated runs only: where they run
  bool json = false;                    // print summary.json instead of the table
  bool verbose = false;                 // print the peers' logs too
};

}  // namespace peerd
