#include "peerd/lab/baselines/command.hpp"

#include <algorithm>

#include "peerd/peer/motion/motion_path.hpp"

namespace peerd::baselines {
namespace {

using replication::BitReader;
using replication::BitWriter;

constexpr std::size_t kKeysMax = 64;  // of one tick

bool is_zero(const Steps& steps) { return steps == Steps{}; }

}  // namespace

KinematicState driven(const Pose& at, const Drive& drive) {
  KinematicState state = at_rest(at);
  state.velocity = from_steps(drive.velocity, kVelocityStep_m_s);
  state.angular_velocity_body = from_steps(drive.spin, kSpinStep_rad_s);
  return state;
}

// The first byte of a drive says which of the two vectors follow.
void put(BitWriter& out, const Command& command) {
  for (const Drive& drive : command.drives) {
    const bool moves = !is_zero(drive.velocity), turns = !is_zero(drive.spin);
    out.put((moves ? 1u : 0u) | (turns ? 2u : 0u), 8);
    if (moves) std::ranges::for_each(drive.velocity, [&](std::int32_t v) { put_signed(out, v); });
    if (turns) std::ranges::for_each(drive.spin, [&](std::int32_t v) { put_signed(out, v); });
  }
  replication::put_varint(out, command.keys.size());
  for (const KeyEvent& key : command.keys) {
    put_signed(out, key.value);
    put_signed(out, key.state);
  }
}

bool take(BitReader& in, std::size_t objects, Command& command) {
  command.drives.assign(objects, {});
  for (Drive& drive : command.drives) {
    const std::uint64_t has = in.get(8);
    if (has > 3) return false;
    const auto take_all = [&](Steps& steps) {
      return std::ranges::all_of(steps, [&](std::int32_t& v) { return take_signed(in, v); });
    };
    if ((has & 1) != 0 && !take_all(drive.velocity)) return false;
    if ((has & 2) != 0 && !take_all(drive.spin)) return false;
  }
  std::uint32_t keys = 0;
  if (!replication::take_varint(in, keys) || keys > kKeysMax) return false;
  command.keys.assign(keys, {});
  return std::ranges::all_of(command.keys,
                             [&](KeyEvent& key) { return take_signed(in, key.value) && take_signed(in, key.state); });
}

CommandSource::CommandSource(const config::Motions& motions, std::vector<config::ScriptedKey> keys)
    : motions_(motions), keys_(std::move(keys)) {}

std::vector<Pose> CommandSource::begin() const {
  std::vector<Pose> poses;
  for (const auto& [object, motion] : motions_) poses.push_back(motion.pose(0.0));
  return poses;
}

Command CommandSource::sample(double t_s, double dt_s, const std::vector<Pose>& at) {
  Command command;
  std::size_t i = 0;
  for (const auto& [object, motion] : motions_) {
    const KinematicState wanted = advance(motion.sample(t_s), dt_s);
    const Vec3 turn = motion::turn_between(at[i].orientation, wanted.orientation);
    command.drives.push_back({in_steps((wanted.position - at[i].position) / dt_s, kVelocityStep_m_s),
                              in_steps(turn / dt_s, kSpinStep_rad_s)});
    ++i;
  }
  for (; next_key_ < keys_.size() && keys_[next_key_].at_s <= t_s && command.keys.size() < kKeysMax; ++next_key_) {
    command.keys.push_back(keys_[next_key_].key);
  }
  return command;
}

}  // namespace peerd::baselines
