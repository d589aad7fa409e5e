#pragma once
#include <cstdint>
#include <vector>

#include "peerd/lab/baselines/steps.hpp"
#include "peerd/peer/config/resolve.hpp"

namespace peerd::baselines {

// How a player moves one driven object during one tick, in whole steps: of kVelocityStep_m_s along the world's axes,
// and of kSpinStep_rad_s about the body's.
struct Drive {
  Steps velocity{}, spin{};
  friend bool operator==(const Drive&, const Drive&) = default;
};
inline constexpr double kVelocityStep_m_s = 0x1p-8;
inline constexpr double kSpinStep_rad_s = 0x1p-10;

// The object at the begin of a tick with that drive: advance() says where it is at the end.
[[nodiscard]] KinematicState driven(const Pose& at, const Drive& drive);

// A player's input of one tick.
struct Command {
  std::vector<Drive> drives;   // of the player's driven objects, in the order of their ids
  std::vector<KeyEvent> keys;  // pressed since the tick before
};
void put(replication::BitWriter& out, const Command& command);
// False: it is cut off, or no command of that many objects.
[[nodiscard]] bool take(replication::BitReader& in, std::size_t objects, Command& command);

// CommandSource makes the inputs of one player: at each tick the drives that keep the driven objects on their motions,
// and the keys.
class CommandSource {
 public:
  // `motions` outlives the source.
  CommandSource(const config::Motions& motions, std::vector<config::ScriptedKey> keys);

  // The input of the tick at t_s [s] after the start, which lasts dt_s. `at`: where the driven objects are then, as the
  // player believes. It goes by the motion's state at t_s, and by nothing later.
  [[nodiscard]] Command sample(double t_s, double dt_s, const std::vector<Pose>& at);
  // The poses of the driven objects at the start.
  [[nodiscard]] std::vector<Pose> begin() const;

 private:
  const config::Motions& motions_;
  std::vector<config::ScriptedKey> keys_;  // by time
  std::size_t next_key_ = 0;
};

}  // namespace peerd::baselines
