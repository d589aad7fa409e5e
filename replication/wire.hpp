#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/ids.hpp"
#include "core/kinematics.hpp"
#include "core/time.hpp"
#include "replication/motion_model.hpp"

namespace peerd::replication {

using Bytes = std::vector<std::byte>;

// The one region that there is yet.
inline constexpr RegionId kWholeScene{0};

// What travels, as the rest of this folder sees it. proto/README.md specifies the bytes and limits.

// A dead-reckoning update: from `at` on, `object` moves as `model` says.
struct UpdateRecord {
  ObjectId object;
  std::uint32_t sequence = 0;  // per sender and boot, from 1; a lower one never replaces a higher one
  SimTime at{};
  MotionModel model;
  // Contact time of the last decision on the object that the sender knew; none: SimTime{}. A state from before a
  // decision must not undo it, although it may be of a later time.
  SimTime decision{};
};

enum class DecisionRule : std::uint8_t { kId = 1 };

// The one outcome of a collision, stated by the peer that decides it. Receiving it twice changes nothing.
struct DecisionRecord {
  ObjectId collider, collidee;
  SimTime contact{};
  Vec3 normal = Vec3::Zero();  // world frame, from the collidee towards the collider
  KinematicState collider_before, collidee_before;
  KinematicState collider_after, collidee_after;
  DecisionRule rule = DecisionRule::kId;
};

// "I got your hello that you sent at their_tx at our_rx": two of NTP's four stamps; the carrying Hello's host_tx is the
// third, its arrival the fourth.
struct ClockEcho {
  PeerId peer;
  HostTime their_tx{};
  HostTime our_rx{};
};

struct Hello {
  std::string name;
  std::uint64_t world_hash = 0;
  HostTime host_tx{};
  bool synchronised = false;  // session_minus_host means something
  Duration session_minus_host{};
  std::uint32_t sessions = 0;  // how many the sender has entered; each began without any updates
  std::vector<ClockEcho> echoes;
  std::vector<ObjectId> enslaved;
  std::optional<SimTime> start;       // when this peer lets motions by formula begin, if it says so
  std::optional<SimTime> world_zero;  // time 0 of the world's TimeSensors
};

struct Message {
  PeerId sender;
  std::uint64_t boot = 0;  // grows with each start of that peer
  bool has_hello = false;
  Hello hello;
  std::vector<UpdateRecord> updates;
  std::vector<DecisionRecord> decisions;
  bool leaving = false;
  std::uint32_t unknown_models = 0;  // updates left out by decode(): they name a model that this build does not know
};

}  // namespace peerd::replication
