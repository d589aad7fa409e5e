#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "peerd/lab/baselines/command.hpp"
#include "peerd/lab/baselines/participant.hpp"

namespace peerd::baselines {

// A player of Doom (id Software, 1993; Ohlenburg 2003, section 4.2.1): each player's input of each tick goes to all,
// and everybody runs a tick once the inputs of all for it are there. So all have the same game, as late as the slowest.
// Each input is sent in two datagrams; a receiver with a gap asks for it, and the sender goes back to there.
//
// Doom stops after 12 ticks without the others' inputs. Here a player waits as long as the network takes, so that the
// game goes on at its pace where the way is long.
class LockstepPlayer final : public Participant {
 public:
  LockstepPlayer(const Setup& setup, std::size_t self, std::unique_ptr<Game> game);

  [[nodiscard]] std::vector<RegionId> regions() const override { return {kAll}; }
  void on_packet(SimTime now, std::span<const std::byte> datagram) override;
  void on_tick(SimTime now, std::int64_t tick) override;
  void record(SimTime now) override;

 private:
  static constexpr RegionId kAll{0};

  // The inputs of one player that have come and are still needed.
  struct Inputs {
    std::map<std::int64_t, Command> by_tick;
    std::int64_t next = 0;           // all before it have come
    bool gap = false;                // later ones have come
    std::int64_t wanted = kNothing;  // of this player's own inputs: the first one that he asks for
    std::vector<Pose> at;            // his driven objects at the next tick
  };
  static constexpr std::int64_t kNothing = -1;

  [[nodiscard]] bool is_player(std::size_t peer) const { return peer < setup_.run.peers.size(); }
  void send_inputs(SimTime now, std::int64_t tick);
  void run_ready_ticks(SimTime now, std::int64_t until);

  std::unique_ptr<Game> game_;
  CommandSource commands_;
  std::vector<Pose> driven_at_;  // own driven objects once all own inputs until now have taken effect
  std::vector<Inputs> players_;  // of all, this one included
};

}  // namespace peerd::baselines
