#pragma once
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "peerd/peer/config/expectations.hpp"
#include "peerd/peer/config/run_settings.hpp"

namespace peerd::config {

inline constexpr std::uint32_t kRepeatMax = 10'000;
inline constexpr std::int64_t kSeedMax = std::numeric_limits<std::int64_t>::max();  // TOML integers are signed

struct Scenario {
  std::string name;
  std::filesystem::path world;
  WorldReading reading;
  std::uint64_t seed = 1;
  std::uint32_t repeat = 1;  // number of runs that differ in their seeds alone
  std::vector<RunSettings> runs;
  std::vector<Expectation> expectations{};
  std::vector<std::string> warnings{};  // one sentence each, such as "FILE:3:1: warning: A is now called B"
};

struct ScenarioRequest {
  std::filesystem::path file;                  // empty: all settings come from `sets`; not read where `text` is given
  std::vector<std::filesystem::path> configs;  // merged over the scenario, in order
  std::vector<std::string> sets;               // KEY=VALUE; a list sweeps, one value ends that key's sweep
  std::optional<std::uint64_t> seed;
  std::optional<std::uint32_t> repeat{};
  bool real = false;  // the sweep leaves out keys that only a simulated network has
  bool sweep = true;  // false: one run, with the values outside of [sweep]
  // The scenario of other peers or of a recording, in place of the file's.
  std::optional<std::string> text = {};
};

[[nodiscard]] Result<Scenario> read_scenario(const ScenarioRequest& request);

// The keys of the network that are not at their defaults, by dotted name: those of [network], and those of islands, by
// their numbers from 0, and links that have another value than [network].
[[nodiscard]] nlohmann::ordered_json network_settings(const RunSettings& run);

}  // namespace peerd::config
