#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/motion/key_codes.hpp"
#include "core/scene/scene.hpp"
#include "peerd/input/world_file.hpp"
#include "peerd/net/settings/transport_settings.hpp"
#include "peerd/peer/config/collision_settings.hpp"
#include "peerd/peer/config/node_pattern.hpp"
#include "peerd/peer/config/scene_edit.hpp"
#include "peerd/peer/motion/motion_settings.hpp"
#include "replication/settings/policy/peer_config.hpp"

namespace peerd::config {

// The largest time or duration [s] that a configuration can name.
inline constexpr double kForever_s = 1e6;

// The tables [replication], [decisions], [relay], [regions] and [collision]: how updates are published and ghosts are
// predicted, which peer decides collisions, and which way states go.
struct ReplicationSettings {
  replication::PublishPolicy policy;
  replication::ConvergencePolicy convergence;
  replication::ConvergencePolicy remote_convergence{replication::ConvergenceMethod::kParabola};
  replication::DecisionSettings decisions;  // without a viewpoint, which is a peer's own
  replication::RelaySettings relay;
  replication::DisplayDelay display_delay;
  replication::BoundedLatency bounded_latency;
  replication::RegionSettings regions;  // the table [regions]
  std::uint32_t tick_hz = 60;
  double settled_hello_period_s = 1.0;
  replication::LargeSession large;
  double clock_ahead_s = 600.0;  // how far others may move session time ahead of a peer's own clocks
  bool steal = false;            // a peer may take an object without asking its owner
  CollisionSettings collision;   // the table [collision]

  // Peers whose hash of the world, the regions, the bound and the engine is another one are of another session.
  [[nodiscard]] std::uint64_t session_hash(std::uint64_t world_hash) const {
    const bool cuts = regions.cell_m > 0.0;
    const std::uint64_t hash = cuts ? large.session_hash(regions.session_hash(world_hash)) : world_hash;
    return collision.session_hash(bounded_latency.session_hash(hash), tick_hz);
  }
};
[[nodiscard]] ReplicationSettings read_replication(TomlReader reader);

// The table [peer.NAME.viewpoint], and each of [[peer.NAME.view]]: where the peer's user looks from.
struct ViewpointSettings {
  std::string object;  // path of the node that carries it; empty: it stands still
  std::vector<double> position{0, 0, 0}, axis{0, 1, 0};
  double angle_deg = 0.0;
  double field_of_view_deg = 45.0;
  double aspect = 4.0 / 3.0;
  std::optional<double> far_m;  // how far it sees, for skip_unseen; none: without end
};

// A press of a key that the peer causes by itself: [[peer.NAME.key]], or an event of kind "key".
struct ScriptedKey {
  double at_s = 0.0;  // after the scenario's start
  KeyEvent key;
};

// The table [peer.NAME.feed]: how external programs send poses of the objects that they move.
struct FeedSettings {
  std::string udp;       // "127.0.0.1:PORT" for datagrams too; empty: by the control socket alone
  double stale_s = 0.5;  // an object stands still after so long without a pose
};

// The table [peer.NAME].
struct PeerSettings {
  std::string name;
  std::uint32_t id = 0;
  std::vector<NodePattern> owns;
  std::map<std::string, motion::MotionSettings> motion;  // by path or pattern; precedes the scenario's motions
  FeedSettings feed;
  std::vector<ScriptedKey> keys;    // by time, then in file order
  std::vector<ScriptedEdit> edits;  // by time
  std::optional<ViewpointSettings> viewpoint;
  std::vector<ViewpointSettings> views;  // besides the viewpoint: mirrors, other windows
  bool skip_unseen = false;
  std::optional<double> interest_radius_m;
  std::optional<std::uint32_t> tick_hz;  // instead of replication.tick_hz
  double clock_offset_s = 0.0;           // for tests: how far this host's clock is ahead
};
// `folder` is the folder that relative file names start from.
[[nodiscard]] PeerSettings read_peer(TomlReader reader, const std::string& name, const std::filesystem::path& folder);

// Reads which key a table means: by its name and the modifiers that are held down, or by its numbers.
[[nodiscard]] KeyEvent read_key(TomlReader& reader);

// Reads the tables below `motion`, by path or pattern.
[[nodiscard]] std::map<std::string, motion::MotionSettings> read_motions(TomlReader& reader,
                                                                         const std::filesystem::path& folder);

// Reads the table [decisions]. `peers` are the peers that may be named as the server.
[[nodiscard]] replication::DecisionSettings read_decisions(TomlReader& reader, const std::vector<PeerSettings>& peers);

// Reads the table [relay].
[[nodiscard]] replication::RelaySettings read_relay(TomlReader reader, const std::vector<PeerSettings>& peers);

// Reads the table [regions]: how the scene is cut, and how eagerly regions are left.
[[nodiscard]] replication::RegionSettings read_regions(TomlReader reader);

[[nodiscard]] net::TransportSettings read_transport(TomlReader reader);

// The table [control]: where a real peer takes requests.
struct ControlSettings {
  std::optional<std::string> socket;  // path; empty: no socket; none: the default path, where there is one
};
[[nodiscard]] ControlSettings read_control(TomlReader reader);

// The table [log].
struct LogSettings {
  bool verbose = false;       // debug lines too
  std::uint32_t burst = 100;  // lines of one kind that go out at once
  double per_second = 1.0;    // lines of one kind after that
};
[[nodiscard]] LogSettings read_log(TomlReader reader);

struct GatewaySettings {
  std::string listen;                // ADDRESS:PORT; empty: there is none
  bool beyond_loopback = false;      // other computers may reach it, though nothing is encrypted
  std::vector<std::string> origins;  // whose pages may ask, beside its own
};
[[nodiscard]] GatewaySettings read_gateway(TomlReader reader);

// The world with its scene and its hash, as every command that makes a peer needs it.
struct LoadedWorld {
  std::filesystem::path path;
  // Hash of the world's files, and of its name where WorldReading has one: peers with other files are in another
  // session.
  std::uint64_t hash = 0;
  Scene scene;
  std::vector<std::string> warnings;  // each as "FILE:LINE:COLUMN: warning: ..", the first ones where there are many
  std::string archive = {};           // packed (WorldArchive), where WorldReading::keeps_archive
};
[[nodiscard]] Result<LoadedWorld> load_world(const std::filesystem::path& path, const WorldReading& reading = {});
// The same of a world whose bytes are here already; `name` stands for its path.
[[nodiscard]] Result<LoadedWorld> load_world(std::string bytes, const std::filesystem::path& name,
                                             const WorldReading& reading);

}  // namespace peerd::config
