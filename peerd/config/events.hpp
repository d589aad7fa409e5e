#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "peerd/config/link_settings.hpp"
#include "peerd/config/peer_settings.hpp"

namespace peerd::config {

enum class EventKind : std::uint8_t { kJoin, kLeave, kKill, kPartition, kHeal, kNetwork, kKey };
[[nodiscard]] std::string_view to_string(EventKind kind);

// The table [event.NAME]: an event that concerns peers or the network at a given time.
struct ScenarioEvent {
  std::string name;
  double at_s = 0.0;  // after the scenario's start
  EventKind kind{};
  std::string peer;                  // joins, leaves, is killed, or gets the key
  std::vector<std::uint32_t> sides;  // kPartition: side of each peer, in the run's order; nothing crosses between sides
  LinkChange change;                 // kNetwork
  std::string from, to;              // kNetwork: ends of the links that change; empty: all peers
  KeyEvent key;                      // kKey
};

// Reads the tables below `event` and sorts them by time, then by name. `peers` are the run's peers in their order.
[[nodiscard]] std::vector<ScenarioEvent> read_events(TomlReader& root, const std::vector<PeerSettings>& peers,
                                                     double duration_s);

// Whether that peer is there from the start, which it is unless its first event is that it joins.
[[nodiscard]] bool starts_with(const std::vector<ScenarioEvent>& events, std::string_view peer);

// Moves the keys among the events into the settings of their peers: each peer presses its own keys, simulated or real.
void give_keys(const std::vector<ScenarioEvent>& events, std::vector<PeerSettings>& peers);

// Whether any peer joins, leaves or is killed during the run.
[[nodiscard]] bool peers_change(const std::vector<ScenarioEvent>& events);

}  // namespace peerd::config
