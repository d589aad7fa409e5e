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

// The table [event.NAME]: what happens to the peers or to the network at a time.
struct ScenarioEvent {
  std::string name;
  double at_s = 0.0;  // after the scenario's start
  EventKind kind{};
  std::string peer;                  // that joins, leaves, is killed or whose key goes down
  std::vector<std::uint32_t> sides;  // partition: of each peer, in the run's order; across sides nothing is heard
  LinkChange change;                 // network
  std::string from, to;              // of the links that change; empty: of all peers
  KeyEvent key;                      // key
};

// The tables below `event`, by time, then by name. `peers` are the run's, in its order.
[[nodiscard]] std::vector<ScenarioEvent> read_events(TomlReader& root, const std::vector<PeerSettings>& peers,
                                                     double duration_s);

// Whether that peer is there from the start: the first that happens to it is not that it joins.
[[nodiscard]] bool starts_with(const std::vector<ScenarioEvent>& events, std::string_view peer);

// Hands the keys among the events to the peers at which they go down: each presses its own, simulated or real.
void give_keys(const std::vector<ScenarioEvent>& events, std::vector<PeerSettings>& peers);

// Whether peers come or go.
[[nodiscard]] bool peers_change(const std::vector<ScenarioEvent>& events);

}  // namespace peerd::config
