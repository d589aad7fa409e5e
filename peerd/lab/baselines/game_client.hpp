#pragma once
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "peerd/lab/baselines/game_server.hpp"

namespace peerd::baselines {

// A client of a GameServer. It shows others between two snapshots, `interpolation_ms` before the newest that it may
// expect, and goes on by their velocity for a quarter of a second where none comes. With prediction it shows its driven
// objects where the inputs since the last state that the server has confirmed bring them; what physics moves is the
// server's alone, the client's own as well.
class GameClient final : public Participant {
 public:
  // The server outlives the client, which asks it for nothing but the truth of what physics moves, for the log.
  GameClient(const Setup& setup, std::size_t self, const GameServer& server);

  [[nodiscard]] std::vector<RegionId> regions() const override { return {to_client(self_)}; }
  void on_packet(SimTime now, std::span<const std::byte> datagram) override;
  void on_tick(SimTime now, std::int64_t tick) override;
  void record(SimTime now) override;

 private:
  struct Snapshot {
    SimTime at;
    KinematicState state;
  };

  // The part of record() that is about own driven objects.
  void record_driven(SimTime now);
  void confirm(const SnapshotHead& head, const Block& states);
  void take_events(SimTime now, replication::BitReader& in);
  void keep(SimTime at, std::size_t block, const Block& states);
  // The time as of which the others are shown.
  [[nodiscard]] SimTime seen_at(SimTime now) const;
  [[nodiscard]] KinematicState seen(ObjectId object, SimTime now) const;
  // Computes `predicted_` anew.
  void predict();

  const GameServer& server_;
  const SimTime start_;
  CommandSource commands_;
  std::vector<ObjectId> objects_;
  std::map<std::uint64_t, Command> unconfirmed_;  // own inputs that some block's last snapshot is without
  struct Confirmed {
    std::uint64_t tick = 0;  // the server has carried out all own inputs before it
    Pose at;                 // of the object after those
  };
  std::vector<Confirmed> confirmed_;  // of own driven objects, each by the last snapshot of its block
  std::uint64_t tick_ = 0;            // the last one
  std::vector<Pose> predicted_;       // own driven objects at the begin of that tick, by the inputs before it
  std::uint64_t last_event_ = 0;
  std::vector<std::map<std::uint64_t, Block>> received_;  // of each block, by number
  std::map<ObjectId, std::deque<Snapshot>> shown_;        // by time
  std::deque<std::pair<SimTime, Duration>> ages_;         // of snapshots on arrival, by arrival
};

}  // namespace peerd::baselines
