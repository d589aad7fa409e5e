#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/ids.hpp"
#include "core/kinematics.hpp"
#include "core/math.hpp"
#include "core/time.hpp"
#include "replication/wire/decision_policy.hpp"
#include "replication/wire/loss_meter.hpp"
#include "replication/motion/motion_model.hpp"

namespace peerd::replication {

using Bytes = std::vector<std::byte>;

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
  // log2 of the step [m] that the position is whole multiples of; the other components' steps follow (record.hpp).
  // None: all components are exact.
  std::optional<int> position_step_log2{};
};

// By which policy the sender was to decide; kId also where nobody else had (fallback).
using DecisionRule = DecisionPolicy;

// The one outcome of a collision, stated by the peer that decides it. Receiving it twice changes nothing.
struct DecisionRecord {
  ObjectId collider, collidee;
  SimTime contact{};
  Vec3 normal = Vec3::Zero();  // world frame, from the collidee towards the collider
  KinematicState collider_before, collidee_before;
  KinematicState collider_after, collidee_after;
  DecisionRule rule = DecisionRule::kId;
  SimTime known{};  // contact time of the last decision on this pair that the sender knew; none: SimTime{}
};

// In a hello: a contact of two peers' objects that the sender has found.
struct ContactNote {
  ObjectId collider, collidee;
  SimTime contact{};
  bool deferred = false;  // the sender has found it, and leaves it to another to decide; else it has decided it itself
};

// As many notes as fit into a hello whose other lists are full.
inline constexpr std::size_t kNotesMax = 8;

// Where a peer looks from: a fixed pose, or one in the frame of an object, whose dead reckoning takes it along.
struct Viewpoint {
  std::optional<ObjectId> object;
  Pose pose;                        // a camera's: looks along -z, y up
  double field_of_view = 0.785398;  // the smaller of the angles of width and height [rad], in (0, pi)
  double aspect = 1.0;              // width / height, > 0
};

// In a hello, to each peer heard: when its last hello came, and what of its datagrams did. The carrying hello's own
// time and its arrival are the other two of NTP's four stamps.
struct Echo {
  PeerId peer;
  std::uint32_t hello = 0;  // the number of its last hello's datagram
  Duration hold_time{0};         // from that one's arrival to this hello
  Received received;        // of its datagrams; the highest is not below `hello`
  double loss = 0.0;        // what gets lost on the way (LossMeter), in thousandths
};

// As many as a hello carries. More take turns in order of their ids, which go round; the next hello begins with this
// one's last, so that any two that follow each other are in one list, which shows who is missing between them.
inline constexpr std::size_t kEchoesMax = 15, kEchoesStep = kEchoesMax - 1;
// In how many hellos all are named.
[[nodiscard]] constexpr std::size_t hellos_to_name(std::size_t peers) {
  return peers <= kEchoesMax ? 1 : (peers + kEchoesStep - 1) / kEchoesStep;
}

// Who the sender is. What changes seldom; it goes with some hellos only.
struct Introduction {
  std::string name;
  std::uint64_t world_hash = 0;
  std::vector<ObjectId> owned;
  std::optional<SimTime> start;       // when this peer lets motions by formula begin, if it says so
  std::optional<SimTime> world_zero;  // time 0 of the world's TimeSensors
  std::optional<Viewpoint> viewpoint;
};

// What the sender's operating system says of its clock: how far that is ahead of session time, and that it is off UTC
// by at most `error`.
struct OsClockNote {
  Duration minus_session{0};
  Duration error{0};  // on the wire, microseconds; rounded up
};

struct Hello {
  std::optional<SimTime> session_tx;  // when it left; none: the sender has no session time
  // How far that may be from the time of the session's leader; on the wire, microseconds, rounded up. None: it leads.
  std::optional<Duration> clock_error;
  std::optional<OsClockNote> os_clock;  // none: not known to be right
  std::uint32_t sessions = 0;           // how many the sender has entered; each began without any updates
  Duration latency{0};                  // how late the sender hears of others (latency_bound), a whole millisecond
  std::vector<Echo> echoes;
  std::vector<ContactNote> notes;  // what is held first, then its newest decisions, until all have them
  std::optional<Introduction> introduction;
};

// Of a boot number, what goes with every datagram; the whole of it goes with introductions.
inline constexpr int kIncarnationLow_bits = 21;
[[nodiscard]] constexpr std::uint64_t incarnation_low(std::uint64_t incarnation) {
  return incarnation & ((std::uint64_t{1} << kIncarnationLow_bits) - 1);
}

// "I listen there since then", or ask anew: who has an object there and has not told of it since tells its state anew.
struct Subscription {
  RegionId region;
  SimTime since{};  // on the wire, milliseconds before the latest of a message's; rounded towards that
};
// As many as fit into a datagram of their own; into a hello with all of its lists full.
inline constexpr std::size_t kSubscriptionsMax = 150, kSubscriptionsWithHello = 8;

// "It is told elsewhere from now on": who does not listen there knows nothing of it any more.
struct Handover {
  ObjectId object;
  std::uint32_t sequence = 0;  // of the update that is told there
  RegionId to;
};

struct Message {
  PeerId sender;
  std::uint64_t incarnation = 0;    // grows with each start of that peer; boot_low() of it where nothing introduces
  std::uint32_t number = 0;  // of the sender's datagrams to that region since then, from 1; 0: not counted
  std::optional<Hello> hello;
  std::vector<UpdateRecord> updates;
  std::vector<DecisionRecord> decisions;
  std::vector<Subscription> subscriptions;
  std::vector<Handover> handovers;  // from the region that the message goes to
  bool leaving = false;
  std::uint32_t unknown_models = 0;  // updates left out by decode(): they name a model that this build does not know

  [[nodiscard]] const Introduction* introduction() const {
    return hello && hello->introduction ? &*hello->introduction : nullptr;
  }
};

}  // namespace peerd::replication
