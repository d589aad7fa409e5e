#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "peerd/peer/config/baseline_settings.hpp"
#include "peerd/peer/config/events.hpp"
#include "peerd/peer/config/link_settings.hpp"
#include "peerd/peer/config/peer_settings.hpp"

namespace peerd::config {

// The settings of one run: every swept key has one value, and the seed is that of one repetition.
struct RunSettings {
  nlohmann::ordered_json params;  // swept and set keys, by dotted name
  std::string toml;               // all settings as one text, for captures
  double duration_s = 15.0;
  std::uint64_t seed = 1;
  std::uint32_t sample_hz = 60;  // samples per second of each observer's error, whatever its tick rate
  ReplicationSettings replication;
  BaselineSettings baseline;
  bool compare_outcomes = false;    // with the same run without latency; simulated runs only
  std::vector<PeerSettings> peers;  // by id
  std::map<std::string, motion::MotionSettings>
      motion;                         // by path or pattern; applies to whichever peer owns the object
  std::vector<ScenarioEvent> events;  // by time, then by name
  LinkSettings network;
  Via via = Via::kNothing;  // real runs only
  // Peers that are near each other in the network, as [[network.island]] says: how datagrams travel between two of
  // them.
  std::vector<LinkSettings> islands;
  std::map<std::string, std::size_t> island_of;  // by the name of a peer: its index in `islands`
  std::map<std::pair<std::string, std::string>, LinkSettings> links;
  net::TransportSettings transport;
  ControlSettings control;
  LogSettings log;
  GatewaySettings gateway;
};

// The network settings that apply to datagrams from one peer to another: those of the link, else of the island that
// both are on, else of the network.
[[nodiscard]] const LinkSettings& link(const RunSettings& run, const std::string& from, const std::string& to);
// All settings of links that a run has: the network's, those within islands, and those between two peers.
[[nodiscard]] std::vector<LinkSettings> links_of(const RunSettings& run);
// The longest delay [s] of any link at any time of the run: its latency, jitter and what events make of them.
[[nodiscard]] double longest_delay_s(const RunSettings& run);

}  // namespace peerd::config
