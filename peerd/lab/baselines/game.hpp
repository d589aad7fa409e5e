#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/motion/key_sensors.hpp"
#include "peerd/peer/config/resolve.hpp"
#include "peerd/peer/node/peer_node.hpp"
#include "replication/peer/peer.hpp"
#include "replication/settings/output/tick_grid.hpp"

namespace peerd::baselines {

// A run's world as one simulation: a peer that is alone and runs the objects of all peers of the run. Driven objects
// move as each tick says, all others by physics and by keys. Games with equal inputs are equal, bit for bit.
class Game {
 public:
  // All arguments outlive the game. `objects`: of each of run.peers, in their order.
  Game(const config::RunSettings& run, const SharedWorld& shared, std::span<const config::PeerObjects> objects);

  // The time at which tick 0 is run, and with it the motions begin: a whole second, the same for all games.
  [[nodiscard]] SimTime start() const { return start_; }
  [[nodiscard]] SimTime time_of(std::int64_t tick) const { return ticks_.time_of(first_tick_ + tick); }
  // The number of ticks that have been run.
  [[nodiscard]] std::int64_t ticks() const { return next_tick_; }

  // Runs the next tick, in which the driven objects have these states.
  void run_tick(std::span<const replication::OwnSample> driven);
  // A key of a player, by its index in run.peers, just after the last tick: it moves what that player owns and nothing
  // drives. False: it changes nothing.
  [[nodiscard]] bool press(std::size_t player, const KeyEvent& key);

  // The state at the last tick, in the world.
  [[nodiscard]] KinematicState state(ObjectId object) const { return peer_->truth(object, now_); }
  // The contacts since the last call, in order of time.
  [[nodiscard]] std::vector<replication::ContactSeen> take_contacts();

 private:
  void drain();

  const SharedWorld& shared_;
  replication::TickGrid ticks_;
  std::unique_ptr<replication::Peer> peer_;
  std::vector<KeySensors> key_sensors_;       // of each player
  std::map<ObjectId, std::size_t> moved_by_;  // the player whose keys move an object: of what nothing drives
  SimTime start_, now_;
  std::int64_t first_tick_ = 0;  // the number of tick 0 on the session's grid
  std::int64_t next_tick_ = 0;
  std::vector<replication::ContactSeen> contacts_;
};

}  // namespace peerd::baselines
