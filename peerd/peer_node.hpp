#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "peerd/config/scenario.hpp"
#include "peerd/peer_log.hpp"
#include "replication/peer.hpp"

namespace peerd {

// What all peers of a run read and none changes.
struct SharedWorld {
  config::LoadedWorld world;
  std::unique_ptr<const replication::WorldModel> model;
};
[[nodiscard]] config::Result<std::unique_ptr<const SharedWorld>> share_world(const std::filesystem::path& path);

// Motions of one peer's driven objects.
using Motions = std::map<ObjectId, config::MotionSource>;
[[nodiscard]] config::Result<Motions> make_motions(const config::PeerSettings& peer, const Scene& scene,
                                                   double duration_s);

// A peer with what moves its objects and what keeps its log: the part of a driver that the real and the simulated world
// share. Still no clock and no socket.
class PeerNode {
 public:
  struct Options {
    std::uint64_t boot = 1;
    std::vector<PeerId> wait_for;  // motions by formula begin when all of these are here; empty: at once
    Duration start_lead{0};        // from then to the first whole second that is at least so far ahead
    Duration clock_offset{0};      // test setting: what this host's clock is ahead of the shared one
    bool keep_log = true;
    std::uint32_t sample_hz = 60;  // how often the log looks at the ghosts, whatever the tick rate
  };

  [[nodiscard]] static config::Result<std::unique_ptr<PeerNode>> make(const config::PeerSettings& settings,
                                                                      const config::ReplicationSettings& replication,
                                                                      const SharedWorld& shared, Motions motions,
                                                                      Options options);

  void on_packet(HostTime now, RegionId region, std::span<const std::byte> datagram);
  void on_tick(HostTime now);
  void leave(HostTime now) { peer_.leave(now); }
  // The next output, already in the log.
  [[nodiscard]] std::optional<replication::Output> poll_output();
  [[nodiscard]] HostTime next_deadline() const;

  [[nodiscard]] const replication::Peer& peer() const { return peer_; }
  // When motions by formula begin; none until everybody is here.
  [[nodiscard]] std::optional<SimTime> start() const { return log_.start; }
  // The log with the counters as they stand now.
  [[nodiscard]] const PeerLog& log();

 private:
  PeerNode(replication::PeerConfig config, const SharedWorld& shared, Motions motions, Options options);
  void agree_on_start(HostTime now);
  [[nodiscard]] SimTime sample_time(std::int64_t number) const;
  void record_truths(SimTime t);
  void record_ghosts(HostTime now);
  void record(SimTime t, ObjectId object, PeerId owner, const KinematicState& state);

  const SharedWorld& shared_;
  Motions motions_;
  Options options_;
  replication::PeerConfig config_;
  replication::Peer peer_;
  PeerLog log_;
  SimTime logged_at_{};                 // the last tick
  std::optional<SimTime> started_for_;  // the start that the peer was told
  std::int64_t next_sample_ = 0;        // counted from the start
};

}  // namespace peerd
