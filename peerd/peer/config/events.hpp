#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "peerd/peer/config/link_settings.hpp"
#include "peerd/peer/config/peer_settings.hpp"
#include "peerd/peer/config/scene_edit.hpp"

namespace peerd::config {

enum class EventKind : std::uint8_t { kJoin, kLeave, kKill, kPartition, kHeal, kNetwork, kKey, kEdit };
[[nodiscard]] std::string_view to_string(EventKind kind);

// The table [event.NAME]: an event that concerns peers or the network at a given time.
struct ScenarioEvent {
  std::string name;
  double at_s = 0.0;  // after the scenario's start
  EventKind kind{};
  std::string peer;                  // joins, leaves, is killed, gets the key, or makes the edit
  std::vector<std::uint32_t> sides;  // kPartition: side of each peer, in the run's order; nothing crosses between sides
  LinkChange change;                 // kNetwork
  std::string from, to;              // kNetwork: ends of the links that change; empty: all peers
  KeyEvent key;                      // kKey
  SceneEdit edit;                    // kEdit: of the kinds add, remove, move and set
};

// Reads the tables below `event` and sorts them by time, then by name. `peers` are the run's peers in their order, and
// `folder` is the scenario's, from which the paths of files start.
[[nodiscard]] std::vector<ScenarioEvent> read_events(TomlReader& root, const std::vector<PeerSettings>& peers,
                                                     double duration_s, const std::filesystem::path& folder);

// Whether that peer is there from the start, which it is unless its first event is that it joins.
[[nodiscard]] bool starts_with(const std::vector<ScenarioEvent>& events, std::string_view peer);

// Moves the keys and the edits among the events into the settings of their peers: each peer presses its own keys and
// makes its own edits, simulated or real.
void give_to_peers(const std::vector<ScenarioEvent>& events, std::vector<PeerSettings>& peers);

// Whether any peer joins, leaves or is killed during the run.
[[nodiscard]] bool peers_change(const std::vector<ScenarioEvent>& events);

}  // namespace peerd::config
