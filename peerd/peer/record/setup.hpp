#pragma once
#include <cstdint>
#include <expected>
#include <filesystem>
#include <string>
#include <vector>

#include "peerd/net/transport/region_groups.hpp"
#include "peerd/peer/config/scenario.hpp"
#include "peerd/peer/node/peer_node.hpp"

namespace peerd::record {

// Everything that a peer is made of, as the head of its capture states it. Of the world it has only the path and a
// hash.
struct Setup {
  std::string peer;             // its name in the configuration
  std::string configuration;    // TOML: scenario, overlays and --set, merged (RunSettings::toml)
  std::filesystem::path file;   // the scenario's; paths in the configuration count from its folder. Absolute
  std::filesystem::path world;  // absolute
  std::uint64_t world_hash = 0;
  WorldReading reading;
  PeerNode::Options options;
  net::GroupPlan groups;                // the regions of the capture's groups
  std::vector<std::byte> author_key{};  // LogSigner::own_key(); empty: its operations are not signed
  std::string roster{};                 // the text of the one that names its members; empty: there is none
  // The session's datagrams were never sealed; they were, and the capture has what they say; or it has them sealed.
  enum class Datagrams : std::uint8_t { kOpen, kOpened, kSealed };
  Datagrams datagrams = Datagrams::kOpen;
};

[[nodiscard]] Setup make_setup(const config::Scenario& scenario, const config::RunSettings& run,
                               const config::PeerSettings& peer, const std::filesystem::path& file,
                               const SharedWorld& shared, const PeerNode::Options& options, net::GroupPlan groups);

// JSON, with the number of its format.
[[nodiscard]] std::string to_text(const Setup& setup);
// Parses hostile input; the error is one sentence.
[[nodiscard]] std::expected<Setup, std::string> setup_from(std::string_view text);

}  // namespace peerd::record
