#pragma once
#include <cstdint>
#include <expected>
#include <filesystem>
#include <string>

#include "peerd/config/scenario.hpp"
#include "peerd/transport/region_groups.hpp"
#include "peerd/node/peer_node.hpp"

namespace peerd::record {

// All that a peer is made of, as it stands at the head of its capture. The world alone stays outside, as a path and a
// hash.
struct Setup {
  std::string peer;             // its name in the configuration
  std::string configuration;    // TOML: what the scenario, its overlays and --set came to (RunSettings::toml)
  std::filesystem::path file;   // the scenario's; paths in the configuration count from its folder. Absolute
  std::filesystem::path world;  // absolute
  std::uint64_t world_hash = 0;
  bool inlines_when_needed = false;
  PeerNode::Options options;
  net::GroupPlan groups;  // which group in the capture stands for which region
};

[[nodiscard]] Setup make_setup(const config::Scenario& scenario, const config::RunSettings& run,
                               const config::PeerSettings& peer, const std::filesystem::path& file,
                               const SharedWorld& shared, const PeerNode::Options& options, net::GroupPlan groups);

// JSON, with a number of its format.
[[nodiscard]] std::string to_text(const Setup& setup);
// Hostile input; the error is one sentence.
[[nodiscard]] std::expected<Setup, std::string> setup_from(std::string_view text);

}  // namespace peerd::record
