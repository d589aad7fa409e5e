#pragma once
#include <deque>
#include <expected>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/motion/key_sensors.hpp"
#include "peerd/peer/config/resolve.hpp"
#include "peerd/peer/config/scenario.hpp"
#include "peerd/peer/feed/pose_feeds.hpp"
#include "peerd/peer/node/awaited_peer.hpp"
#include "peerd/peer/node/key_report.hpp"
#include "peerd/peer/node/peer_edits.hpp"
#include "peerd/peer/node/peer_log.hpp"
#include "replication/peer/peer.hpp"

namespace peerd {

// The world that all peers of a run read and none of them changes.
struct SharedWorld {
  config::LoadedWorld world;
  std::unique_ptr<const replication::WorldModel> model;
  // Returns a sentence for each thing that the world asks for in vain, and for each other warning about it.
  [[nodiscard]] std::vector<std::string> findings() const;
};
// `runs`: what their peers own carries what is below it, and goes with what carries it.
[[nodiscard]] Result<std::unique_ptr<const SharedWorld>> share_world(const std::filesystem::path& path,
                                                                     const WorldReading& reading = {},
                                                                     std::span<const config::RunSettings> runs = {});
[[nodiscard]] std::unique_ptr<const SharedWorld> share_world(config::LoadedWorld world,
                                                             std::span<const config::RunSettings> runs);

// A peer together with the sources of its objects' motion and with its log: the part of a driver that the real and the
// simulated world share. Sans-IO, as the peer itself.
class PeerNode {
 public:
  struct Options {
    std::uint64_t incarnation = 1;
    std::vector<AwaitedPeer> wait_for;  // motions begin once all of these peers are members; empty: at once
    // The session has begun without this peer, which adopts the announced start. Where all peers have come late and
    // nobody announces one, they begin anew.
    bool late = false;
    // This peer has no part in the scenario: unless it founds the session and the file gives its founder something, it
    // does not begin the motions, nor the world's time, but adopts a start.
    bool watches = false;
    Duration start_lead{0};    // the start is the first whole second at least this long after all peers are here
    Duration clock_offset{0};  // test setting: how far this host's clock is ahead of the shared clock
    bool keep_log = true;
    std::uint32_t sample_hz = 60;  // rate of the ghosts' samples in the log, independent of the tick rate
    // The author that the store is for, and what it holds: PeerConfig. `stores`: somebody writes what LogGrown says.
    std::optional<replication::AuthorId> author{};
    replication::RareBranches rare{};
    std::vector<replication::OperationPart> log{};
    std::uint64_t line = 0;                          // of descent, of that
    bool joins = false;                              // both are from peers that are in a session
    const replication::LogSigner* signer = nullptr;  // of operations; it outlives the peer
    bool stores = false;
    // The driver seals by this what it sends, as the status says; empty: it does not.
    std::string sealed_by{};
    LogRows* rows = nullptr;  // what takes the log's samples, updates and datagrams; null: the log keeps them
  };

  // `objects` are the resolved objects of `settings`.
  [[nodiscard]] static std::unique_ptr<PeerNode> make(const config::PeerSettings& settings,
                                                      const config::ReplicationSettings& replication,
                                                      const SharedWorld& shared, config::PeerObjects objects,
                                                      Options options);

  void on_packet(HostTime now, RegionId region, std::span<const std::byte> datagram);
  void on_tick(HostTime now);
  void follow_writers() { peer_.follow_writers(); }
  void on_os_clock(HostTime now, std::optional<replication::OsClock> clock) { peer_.on_os_clock(now, clock); }
  // A key is pressed at this peer: its KeySensors change the velocity of objects that it owns. Releases have no effect.
  // Each automatic repeat that the caller passes on counts as a press, as in the toolkit of Ohlenburg 2003.
  KeyReport on_key(HostTime now, const KeyEvent& key);
  // Somebody asks this peer for an edit of the scene. It takes effect at all peers at one instant, a little later.
  EditReport edit(HostTime now, const config::SceneEdit& edit);
  // Returns what has become of an operation of this peer so far; null: it is none.
  [[nodiscard]] std::optional<OperationState> operation(replication::OperationId id) const { return edits_.find(id); }
  // The store has that operation of this peer, and all before it.
  void note_stored(replication::OperationId last) { edits_.note_stored(last); }
  // The store could not be written: nothing of what has been made since is said to be stored.
  void note_store_failed() { ++store_failures_; }
  // The options that it was made of; their line is that of its edits at present.
  [[nodiscard]] const Options& options() const { return options_; }
  // The line of a session that others are in and that its edits are not for: whoever runs it may make it anew without
  // them. None: it has met no such session.
  [[nodiscard]] std::optional<std::uint64_t> goes_over() const { return goes_over_; }
  // An external program sends poses of the objects that it moves. An update of each object whose ghost is beyond its
  // threshold leaves at once. Unix time + `host_minus_wall` is the time of this host.
  // So is what this peer has grabbed, from the first pose that is taken until it is released.
  feed::Outcome on_poses(HostTime now, Duration host_minus_wall, std::span<const feed::FedPose> poses);
  // Poses move that object no more, which this peer has grabbed and goes on to own: it moves as its last poses moved
  // it, until the next one. The error says why not.
  std::expected<void, std::string> let_go(HostTime now, const std::string& path);
  // From now on this peer looks from there, and all peers know: the viewpoint's frame is that of the node at the path,
  // empty: the world's. None: as the configuration says.
  std::expected<void, std::string> look_from(const std::string& path, std::optional<replication::Viewpoint> viewpoint);
  // Counts a datagram of the pose port that is no message of poses.
  void refuse_poses(const std::string& why) { feeds_.refuse_message(why); }
  void leave(HostTime now);
  // The next output, which the log has recorded already.
  [[nodiscard]] std::optional<replication::Output> poll_output();
  void reuse(replication::Bytes&& datagram) { peer_.reuse(std::move(datagram)); }  // as Peer::reuse()
  // The effect of the next key, whether it came by on_key() or from the settings.
  [[nodiscard]] std::optional<KeyReport> poll_key_report();
  // Returns what has become of the next edit, whether it came by edit() or from the settings.
  [[nodiscard]] std::optional<EditReport> poll_edit_report() { return edits_.poll(); }
  // The next event of the feeds that is worth a log line.
  [[nodiscard]] std::optional<feed::Notice> poll_feed_notice() { return feeds_.poll_notice(); }
  [[nodiscard]] HostTime next_deadline() const;

  // Brings what this peer shows to a viewer to `now`, and returns the session time of that picture; none before a
  // session. It is not before that of the `last` picture, and no later than what is due next, so that the log's own
  // pictures come in their order. Nothing that other peers could notice depends on it.
  [[nodiscard]] std::optional<SimTime> advance_view(HostTime now, std::optional<SimTime> last);
  // The pose that a viewer draws, at the time of the last advance_view() (Peer::shown).
  [[nodiscard]] Pose shown(ObjectId object, SimTime t) { return peer_.shown(object, t); }

  [[nodiscard]] std::optional<Duration> bound(SimTime t) { return peer_.bound(t); }  // as Peer::bound()

  [[nodiscard]] const replication::Peer& peer() const { return peer_; }
  [[nodiscard]] const Scene& scene() const { return peer_.scene(); }
  [[nodiscard]] const std::string& name() const { return config_.name; }
  // Whether a motion of the configuration or an external program drives the object, so that keys and collisions do not.
  [[nodiscard]] bool drives(ObjectId object) const { return motions_.contains(object) || feeds(object); }
  // Whether an external program moves the object.
  [[nodiscard]] bool feeds(ObjectId object) const { return feeds_.feeds(object); }
  // The peers that are not here yet and without which motions don't begin; none once the start is known.
  [[nodiscard]] std::vector<AwaitedPeer> missing() const;
  // The start of the motions; none until all awaited peers are here.
  [[nodiscard]] std::optional<SimTime> start() const { return log_.start; }
  // The log with the counters as they stand now.
  [[nodiscard]] const PeerLog& log();

 private:
  PeerNode(replication::PeerConfig config, const SharedWorld& shared, config::Motions motions, feed::PoseFeeds feeds,
           std::vector<config::ScriptedKey> keys, std::vector<config::ScriptedEdit> edits, Options options);
  KeyReport press(HostTime now, const KeyEvent& key);
  [[nodiscard]] std::string why_not(HostTime now, const KeyReport::Change& change) const;
  [[nodiscard]] SimTime key_time(std::size_t key) const { return *log_.start + from_seconds(keys_[key].at_s); }
  void press_keys(HostTime now);
  void make_edits(HostTime now);
  EditReport undo(HostTime now, const config::SceneEdit& edit);
  EditReport change_owner(HostTime now, const config::SceneEdit& edit);
  void feed_grabbed(HostTime now, const std::string& path);
  void drive_fed(HostTime now);
  void let_go(HostTime now, ObjectId object);
  void let_go_of_lost(HostTime now);
  void on_request(HostTime now, const replication::ObjectRequested& asked);
  void follow_scene();
  // The session time of the next edit of the settings; max(): none is left, or the start is not known.
  [[nodiscard]] SimTime next_edit_at() const;
  void note_path(ObjectId object);  // of an object in a row of the log
  [[nodiscard]] PeerId starter() const;
  void agree_on_start(HostTime now);
  void follow_start(HostTime now, SimTime start);
  [[nodiscard]] SimTime sample_time(std::int64_t number) const;
  void record_truths(SimTime t);
  void record_ghosts(HostTime now);
  void note_bound(Duration bound);
  void record(SimTime t, ObjectId object, PeerId owner, const KinematicState& state, const Pose& shown);

  const SharedWorld& shared_;
  config::Motions motions_;
  feed::PoseFeeds feeds_;
  std::set<ObjectId> fed_while_held_;  // those of `feeds_` that no configuration names
  Options options_;
  std::optional<std::uint64_t> goes_over_;
  replication::PeerConfig config_;
  replication::Peer peer_;
  PeerLog log_;
  std::vector<replication::OwnSample> samples_;  // input of the peer's next tick
  std::uint32_t groups_ = 0;                     // regions that are joined now
  SimTime logged_at_{};                          // the last tick
  std::optional<SimTime> started_for_;           // the start that the peer was given last
  std::optional<HostTime> complete_since_;       // all that are waited for are members
  bool announces_start_ = false;
  std::int64_t next_sample_ = 0;  // counted from the start
  KeySensors key_sensors_;
  std::uint64_t keys_of_scene_ = 0;        // PeerCounters::scene_changes when these were read
  std::vector<config::ScriptedKey> keys_;  // by time
  std::size_t next_key_ = 0;
  std::deque<KeyReport> key_reports_;
  PeerEdits edits_;
  std::uint64_t store_failures_ = 0;
  struct KeyCounters {
    std::uint64_t pressed = 0, unhandled = 0, changes = 0, changes_refused = 0;
  } key_counters_;
};

}  // namespace peerd
