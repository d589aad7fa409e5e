#pragma once
#include <cstdint>
#include <expected>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "peerd/peer/config/scenario.hpp"
#include "peerd/peer/node/peer_node.hpp"

namespace peerd::record {

// Everything that the runs of a simulation are made of, as rerun.json in its output folder states it: a run is a
// function of that, and can be made again. Of the world it has only the path and a hash.
struct Rerun {
  std::string name;             // of the scenario
  std::filesystem::path file;   // the scenario's; paths in the configurations count from its folder. Absolute
  std::filesystem::path world;  // absolute
  std::uint64_t world_hash = 0;
  WorldReading reading;
  std::vector<std::string> configurations;  // TOML, of each run (RunSettings::toml)
};

inline constexpr const char* kRerunFile = "rerun.json";

[[nodiscard]] Rerun make_rerun(const config::Scenario& scenario, const std::filesystem::path& file,
                               const SharedWorld& shared);

// JSON, with the number of its format.
[[nodiscard]] std::string to_text(const Rerun& rerun);
// Parses hostile input; the error is one sentence.
[[nodiscard]] std::expected<Rerun, std::string> rerun_from(std::string_view text);

}  // namespace peerd::record
