#pragma once
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/motion/key_sensors.hpp"
#include "peerd/config/resolve.hpp"
#include "peerd/config/scenario.hpp"
#include "peerd/feed/pose_feeds.hpp"
#include "peerd/node/key_report.hpp"
#include "peerd/node/peer_log.hpp"
#include "replication/peer.hpp"

namespace peerd {

// What all peers of a run read and none changes.
struct SharedWorld {
  config::LoadedWorld world;
  std::unique_ptr<const replication::WorldModel> model;
};
[[nodiscard]] Result<std::unique_ptr<const SharedWorld>> share_world(const std::filesystem::path& path,
                                                                             bool inlines_when_needed = false);

// A peer with what moves its objects and what keeps its log: the part of a driver that the real and the simulated world
// share. Still no clock and no socket.
class PeerNode {
 public:
  struct Options {
    std::uint64_t incarnation = 1;
    std::vector<PeerId> wait_for;  // motions begin when all of these are here; empty: at once
    bool late = false;             // the others have begun without it: it takes the start that they say
    Duration start_lead{0};        // from then to the first whole second that is at least so far ahead
    Duration clock_offset{0};      // test setting: what this host's clock is ahead of the shared one
    bool keep_log = true;
    std::uint32_t sample_hz = 60;  // how often the log looks at the ghosts, whatever the tick rate
  };

  // `objects` are those of the settings.
  [[nodiscard]] static std::unique_ptr<PeerNode> make(const config::PeerSettings& settings,
                                                      const config::ReplicationSettings& replication,
                                                      const SharedWorld& shared, config::PeerObjects objects,
                                                      Options options);

  void on_packet(HostTime now, RegionId region, std::span<const std::byte> datagram);
  void on_tick(HostTime now);
  void on_os_clock(HostTime now, std::optional<replication::OsClock> clock) { peer_.on_os_clock(now, clock); }
  // A key goes down at this peer: its KeySensors change the velocity of objects that it runs. A release means nothing,
  // and each repeat of a key that is held down counts if the caller passes it on, as in the seed's toolkit.
  KeyReport on_key(HostTime now, const KeyEvent& key);
  // A program outside says where objects are that it moves; what the others believe too wrong goes out at once.
  // host_minus_wall: what this host's time is ahead of Unix time.
  feed::Outcome on_poses(HostTime now, Duration host_minus_wall, std::span<const feed::FedPose> poses);
  void refuse_poses(const std::string& why) { feeds_.refuse_message(why); }
  void leave(HostTime now);
  // The next output, already in the log.
  [[nodiscard]] std::optional<replication::Output> poll_output();
  void reuse(replication::Bytes&& datagram) { peer_.reuse(std::move(datagram)); }  // as the peer's
  // What became of the next key, whether it came by on_key() or from the settings: for a log.
  [[nodiscard]] std::optional<KeyReport> poll_key_report();
  // What is new of the programs that move objects: for a log.
  [[nodiscard]] std::optional<feed::Notice> poll_feed_notice() { return feeds_.poll_notice(); }
  [[nodiscard]] HostTime next_deadline() const;

  [[nodiscard]] const replication::Peer& peer() const { return peer_; }
  [[nodiscard]] const Scene& scene() const { return shared_.world.scene; }
  [[nodiscard]] const std::string& name() const { return config_.name; }
  [[nodiscard]] const std::optional<replication::Viewpoint>& viewpoint() const { return config_.decisions.viewpoint; }
  // Driven here, so not by keys or collisions.
  [[nodiscard]] bool drives(ObjectId object) const { return motions_.contains(object) || feeds(object); }
  // Moved by a program outside.
  [[nodiscard]] bool feeds(ObjectId object) const { return feeds_.feeds(object); }
  // When motions begin; none until everybody is here.
  [[nodiscard]] std::optional<SimTime> start() const { return log_.start; }
  // The log with the counters as they stand now.
  [[nodiscard]] const PeerLog& log();

 private:
  PeerNode(replication::PeerConfig config, const SharedWorld& shared, config::Motions motions, feed::PoseFeeds feeds,
           std::vector<config::ScriptedKey> keys, Options options);
  KeyReport press(HostTime now, const KeyEvent& key);
  [[nodiscard]] std::string why_not(HostTime now, const KeyReport::Change& change) const;
  [[nodiscard]] SimTime key_time(std::size_t key) const { return *log_.start + from_seconds(keys_[key].at_s); }
  void press_keys(HostTime now);
  void agree_on_start(HostTime now);
  void follow_start(HostTime now);
  [[nodiscard]] SimTime sample_time(std::int64_t number) const;
  void record_truths(SimTime t);
  void record_ghosts(HostTime now);
  void record(SimTime t, ObjectId object, PeerId owner, const KinematicState& state, const Pose& shown);

  const SharedWorld& shared_;
  config::Motions motions_;
  feed::PoseFeeds feeds_;
  Options options_;
  replication::PeerConfig config_;
  replication::Peer peer_;
  PeerLog log_;
  std::vector<replication::OwnSample> samples_;  // what the peer is told next
  std::uint32_t groups_ = 0;                     // that it listens to now
  SimTime logged_at_{};                          // the last tick
  std::optional<SimTime> started_for_;           // the start that the peer was told
  bool announces_start_ = false;
  std::int64_t next_sample_ = 0;  // counted from the start
  KeySensors key_sensors_;
  std::vector<config::ScriptedKey> keys_;  // by time
  std::size_t next_key_ = 0;
  std::deque<KeyReport> key_reports_;
  std::uint64_t keys_pressed_ = 0, keys_unhandled_ = 0, key_changes_ = 0, key_changes_refused_ = 0;
};

}  // namespace peerd
