#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/motion/key_codes.hpp"
#include "core/scene/scene.hpp"
#include "peerd/motion/motion_settings.hpp"
#include "peerd/config/node_pattern.hpp"
#include "replication/policy/peer_config.hpp"

namespace peerd::config {

// The largest time or duration [s] that a configuration can name.
inline constexpr double kForever_s = 1e6;

// The tables [replication], [decisions] and [relay]: how updates are published and ghosts believed, who decides
// collisions, and which way states go.
struct ReplicationSettings {
  replication::PublishPolicy policy;
  replication::ConvergencePolicy convergence;
  replication::DecisionSettings decisions;  // no viewpoint: that is a peer's
  replication::RelaySettings relay;
  replication::DisplayDelay display_delay;
  replication::RegionSettings regions;  // the table [regions]
  std::uint32_t tick_hz = 60;
  double settled_hello_period_s = 1.0;
};
[[nodiscard]] ReplicationSettings read_replication(TomlReader reader);

// The table [peer.NAME.viewpoint]: where its user looks from, for decisions by field of view.
struct ViewpointSettings {
  std::string object;  // path of what it moves with; empty: it stands
  std::vector<double> position{0, 0, 0}, axis{0, 1, 0};
  double angle_deg = 0.0;
  double field_of_view_deg = 45.0;
  double aspect = 4.0 / 3.0;
};

// [[peer.NAME.key]] or an event of kind "key": a key that goes down by itself.
struct ScriptedKey {
  double at_s = 0.0;  // after the scenario's start
  KeyEvent key;
};

// The table [peer.NAME.feed]: how programs tell where the objects are that they move.
struct FeedSettings {
  std::string udp;       // "127.0.0.1:PORT" for datagrams too; empty: by the control socket alone
  double stale_s = 0.5;  // without a pose for so long an object stands
};

// The table [peer.NAME].
struct PeerSettings {
  std::string name;
  std::uint32_t id = 0;
  std::vector<NodePattern> owns;
  std::map<std::string, MotionSettings> motion;  // by path or pattern, before those of the scenario
  FeedSettings feed;
  std::vector<ScriptedKey> keys;  // by time, then as in the file
  std::optional<ViewpointSettings> viewpoint;
  std::optional<double> interest_radius_m;
  std::optional<std::uint32_t> tick_hz;  // instead of replication.tick_hz
  double clock_offset_s = 0.0;           // test setting: this host's clock is so far ahead
};
// `folder`: what files are relative to.
[[nodiscard]] PeerSettings read_peer(TomlReader reader, const std::string& name, const std::filesystem::path& folder);

// Which key a table means: by its name and what is held down with it, or by its numbers.
[[nodiscard]] KeyEvent read_key(TomlReader& reader);

// The tables below `motion`, by path or pattern.
[[nodiscard]] std::map<std::string, MotionSettings> read_motions(TomlReader& reader,
                                                                 const std::filesystem::path& folder);

// The table [decisions]; `peers` are those that may be named the server.
[[nodiscard]] replication::DecisionSettings read_decisions(TomlReader& reader, const std::vector<PeerSettings>& peers);

// The table [relay].
[[nodiscard]] replication::RelaySettings read_relay(TomlReader reader, const std::vector<PeerSettings>& peers);

// The table [regions]: how the scene is cut, and how eagerly regions are left.
[[nodiscard]] replication::RegionSettings read_regions(TomlReader reader);

// How a real peer reaches the others: the table [transport].
struct TransportSettings {
  std::string interface;               // empty: the only one that can multicast, else lo
  std::string group = "239.192.80.0";  // of region 0
  std::uint32_t group_pool = 0;        // groups that all regions share; 0: each has its own
  std::optional<std::uint32_t> port;   // 47474, and for `peerd scenario` one of its own
  std::uint32_t ttl = 1;
  std::uint32_t dscp = 0;
  std::uint32_t receive_buffer_bytes = 1024 * 1024;
  std::uint32_t busy_poll_us = 0;  // looks for more, before it sleeps; 0: sleeps at once
  std::size_t multicast = 0;       // kMulticastAuto and its like
  std::vector<std::string> peers;  // "HOST:PORT": whom unicast greets first
};
inline constexpr std::size_t kMulticastAuto = 0, kMulticastAlways = 1, kMulticastNever = 2;  // TransportSettings
[[nodiscard]] TransportSettings read_transport(TomlReader reader);

// Where a real peer can be asked and told things: the table [control].
struct ControlSettings {
  std::optional<std::string> socket;  // a path; empty: nowhere; none: the default, where there is one
};
[[nodiscard]] ControlSettings read_control(TomlReader reader);

// The world, as every command of a peer needs it.
struct LoadedWorld {
  std::filesystem::path path;
  std::uint64_t hash = 0;  // of its files; peers with other bytes do not share a session
  Scene scene;
};
[[nodiscard]] Result<LoadedWorld> load_world(const std::filesystem::path& path, bool inlines_when_needed = false);

// The node of that path, or a sentence that names the closest one.
[[nodiscard]] Result<ObjectId> find_object(const Scene& scene, const std::string& path, const std::string& asked_by);

}  // namespace peerd::config
