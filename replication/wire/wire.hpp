#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/ids.hpp"
#include "core/kinematics.hpp"
#include "core/math.hpp"
#include "core/time.hpp"
#include "replication/physics/laws/motion_model.hpp"
#include "replication/wire/decision_policy.hpp"
#include "replication/wire/loss_meter.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::replication {

using Bytes = std::vector<std::byte>;

// The messages that travel, as the rest of this folder sees them. proto/README.md specifies the bytes and limits.

// The drive of an object that others bear or push: the acceleration that it would have without them, and the instant
// from which on its owner has given it that acceleration.
struct Drive {
  Vec3 acceleration = Vec3::Zero();  // [m/s^2], in the frame of the update that states it
  SimTime since{};                   // not later than the update
};

// A dead-reckoning update: from `at` on, `object` moves as `model` says.
struct UpdateRecord {
  ObjectId object;
  std::uint32_t sequence = 0;  // per sender and incarnation, from 1; a lower one never replaces a higher one
  SimTime at{};
  MotionModel model;
  // Contact time of the last decision on the object that the sender knew; none: SimTime{}. A state from before a
  // decision must not undo it, although it may be of a later time.
  SimTime decision{};
  // log2 of the step [m] that the position is whole multiples of; the other components' steps follow (record.hpp).
  // None: all components are exact.
  std::optional<int> position_step_log2{};
  // The carrier in whose frame the model is, a node above the object; none: the world. A sender that does not know yet
  // that something moves there names a frame further out.
  std::optional<ObjectId> carrier{};
  // Others bear or push the object, and the model's acceleration is what they leave of this one. None: nothing does.
  std::optional<Drive> drive{};
};

// The policy by which the sender was to decide; kId also for a decision by fallback, when nobody else had decided.
using DecisionRule = DecisionPolicy;

// The outcome of a collision, stated by the peer that decides it. A second copy changes nothing.
struct DecisionRecord {
  ObjectId collider, collidee;
  SimTime contact{};
  Vec3 normal = Vec3::Zero();  // world frame, from the collidee towards the collider
  KinematicState collider_before, collidee_before;
  KinematicState collider_after, collidee_after;
  DecisionRule rule = DecisionRule::kId;
  SimTime known{};  // contact time of the last decision on this pair that the sender knew; none: SimTime{}
  // The two rest against each other from the contact on. Each receiver solves that contact by itself.
  bool rests = false;
  // For two that rest: the accelerations that they would have if nothing bore them [m/s^2, world frame]. None: the
  // acceleration before the contact.
  std::optional<Vec3> collider_free{}, collidee_free{};
};

// A note in a hello: a contact of two peers' objects that the sender has found.
struct ContactNote {
  ObjectId collider, collidee;
  SimTime contact{};
  bool deferred = false;  // the sender leaves the decision to another peer; else it has decided itself
};

// The number of notes that fit into a hello whose other lists are full.
inline constexpr std::size_t kNotesMax = 8;

// The viewpoint of a peer: a fixed pose, or one in the frame of an object, which carries it along by dead reckoning.
struct Viewpoint {
  std::optional<ObjectId> object;
  Pose pose;                        // the pose of a camera that looks along -z, with y up
  double field_of_view = 0.785398;  // the smaller of the angles of width and height [rad], in (0, pi)
  double aspect = 1.0;              // width / height, > 0
};

// An echo in a hello, one for each peer that the sender receives: when that peer's last hello arrived, and which of its
// datagrams did. The time of the hello that carries the echo and the arrival of that hello are the other two of NTP's
// four stamps.
struct Echo {
  PeerId peer;
  std::uint32_t hello = 0;  // the number of its last hello's datagram
  Duration hold_time{0};    // from the arrival of that hello to this one
  Received received;        // of that peer's datagrams; the highest is not below `hello`
  double loss = 0.0;        // the part that is lost on the way (LossMeter), in thousandths on the wire
};

// The echoes that a hello carries. If there are more, they take turns in order of their ids, which go round; the next
// hello begins with the last one of this hello, so that any two that follow each other are in one list, which shows
// which peers are missing between them.
inline constexpr std::size_t kEchoesMax = 13, kEchoesStep = kEchoesMax - 1;
// The number of hellos in which all peers are named, >= 1.
[[nodiscard]] constexpr std::size_t hellos_to_name(std::size_t peers) {
  return peers <= kEchoesMax ? 1 : (peers + kEchoesStep - 1) / kEchoesStep;
}
static_assert(hellos_to_name(0) == 1 && hellos_to_name(kEchoesMax) == 1 && hellos_to_name(kEchoesMax + 1) == 2);

// The part of a hello that names the sender. It changes seldom and goes with some hellos only.
struct Introduction {
  std::string name;
  std::uint64_t world_hash = 0;
  std::vector<ObjectId> owned;
  // Bit k: the sender owns owned[k] because the world's file gives it to the founder of the session (`enslaved`).
  std::uint64_t owned_as_founder = 0;
  std::optional<SimTime> start;       // when this peer lets motions by formula begin; none: it does not say
  std::optional<SimTime> world_zero;  // time 0 of the world's TimeSensors
  std::optional<Viewpoint> viewpoint;
  std::uint64_t line = 0;  // of descent, of the sender's edits
  bool has_edits = false;  // that it holds, its own or others'
};

// The clock of the sender's operating system: how far it is ahead of session time, and that it is off UTC by at most
// `error`.
struct OsClockNote {
  Duration minus_session{0};
  Duration error{0};  // on the wire, microseconds; rounded up
};

struct Hello {
  std::optional<SimTime> session_tx;  // when the hello left; none: the sender has no session time
  // The greatest distance of session_tx from the time of the session's leader; on the wire, microseconds, rounded up.
  // None: the sender leads.
  std::optional<Duration> clock_error;
  std::optional<OsClockNote> os_clock;  // none: not known to be right
  std::uint32_t sessions = 0;  // the number of sessions that the sender has entered; each began without any updates
  Duration latency{0};         // how late the sender receives other peers (latency_bound), in whole milliseconds
  std::vector<Echo> echoes;
  // Deferred contacts first, then the newest decisions of the sender, until all peers have them.
  std::vector<ContactNote> notes;
  std::optional<Introduction> introduction;
  std::uint64_t scene_digest = 0;  // of the SceneStates that the sender holds; 0: none
  // Logs of operations, ascending by author. What has no place takes turns: an author without an entry means nothing.
  std::vector<LogLength> logs;
};

// The low bits of the incarnation go with every datagram; the whole of it goes with introductions.
inline constexpr int kIncarnationLow_bits = 21;
[[nodiscard]] constexpr std::uint64_t incarnation_low(std::uint64_t incarnation) {
  return incarnation & ((std::uint64_t{1} << kIncarnationLow_bits) - 1);
}

// A peer listens to the region since then, or asks anew: an owner of an object there that has not published it since
// then publishes it anew.
struct Subscription {
  RegionId region;
  SimTime since{};  // on the wire, milliseconds before the latest one of the message, rounded towards that
};
// The numbers of subscriptions that fit into a datagram of their own, and into a hello with all of its lists full.
inline constexpr std::size_t kSubscriptionsMax = 150, kSubscriptionsWithHello = 8;

// An object is published in another region from now on: a peer that does not listen there receives nothing of it any
// more.
struct Handover {
  ObjectId object;
  std::uint32_t sequence = 0;  // of the update that is published there
  RegionId to;
};

// The motions of scene objects that a contact has moved and that nobody owns any more. `decision` of a state is the
// contact time of the decision that last gave the object an owner (none: scene objects met), and `sequence` counts what
// is known under that decision.
struct SceneStates {
  SimTime since{};  // the session time since which the sender, or whoever it has them from, has computed what they meet
  std::vector<UpdateRecord> states;  // exact ones, of any age
};

// ---- what peers believe of each other's ghosts (replication/objects/ghosts) ----

// Digests are of instants that are multiples of this in session time; a byte on the wire says which.
inline constexpr Duration kGhostGrid = std::chrono::milliseconds(250);
// The ids of an owner's objects divide them into kGhostGroups groups, and each group into kGhostBuckets buckets.
inline constexpr std::size_t kGhostGroups = 4, kGhostBuckets = 32;

// A number for each group of the sender's objects, by the places at which the sender believes that every receiver shows
// them at that instant. The number of a group without objects is 0.
struct GhostDigest {
  SimTime at{};
  std::array<std::uint16_t, kGhostGroups> groups{};
  friend bool operator==(const GhostDigest&, const GhostDigest&) = default;
};
// To the owner of a group whose digest is not the sender's: the sender's numbers, by buckets.
struct GhostQuestion {
  PeerId owner;
  RegionId region;  // of the objects that are meant; kWholeScene where the scene is not cut
  SimTime at{};
  std::uint32_t group = 0;  // < kGhostGroups
  std::array<std::uint16_t, kGhostBuckets> buckets{};
};
// The ghosts of own objects in buckets that differ: the state at that instant, the number of the last update, and the
// last decision.
struct GhostAnswer {
  std::vector<UpdateRecord> states;  // all of one instant, exact
};
// To the object's owner: the sender has shown the object at that distance from where the owner believed it.
struct GhostReport {
  ObjectId object;
  float distance_m = 0.0f;  // finite, >= 0
};
inline constexpr std::size_t kGhostReportsMax = 16, kGhostAnswerMax = 12;

// A program that starts asks whether a peer of its id, the sender's, is alive in a world, or such a peer answers that
// it is. Peers of other ids have nothing to do with it.
struct IdentityCheck {
  std::uint64_t asker = 0;  // the incarnation of the program that asks
  std::uint64_t world_hash = 0;
  bool answers = false;
};

// No far hello promises the next one later than that.
inline constexpr std::chrono::milliseconds kNextHelloMax = std::chrono::hours(24);

struct Message {
  PeerId sender;
  std::uint64_t incarnation = 0;  // grows with each start of that peer; incarnation_low() of it without an introduction
  std::uint32_t number = 0;  // counts the sender's datagrams to that region since its start, from 1; 0: not counted
  std::optional<Hello> hello;
  std::vector<UpdateRecord> updates;
  std::vector<DecisionRecord> decisions;
  std::vector<Subscription> subscriptions;
  std::vector<Handover> handovers;  // from the region that the message goes to
  SceneStates scene;
  std::vector<OperationPart> operations;
  std::vector<OperationRange> operation_requests;
  bool leaving = false;
  // In a large session (LargeSession): what would go to all goes to the regions where the sender publishes, and counts
  // its `number` apart.
  bool nearby = false;
  // A far hello, to all peers of a large session: the next one comes within that time. On the wire, milliseconds.
  std::optional<Duration> next_hello;
  std::optional<IdentityCheck> identity;
  std::optional<GhostDigest> ghosts;
  std::optional<GhostQuestion> ghost_question;
  GhostAnswer ghost_answer;
  std::vector<GhostReport> ghost_reports;
  // The updates that decode() left out, because they name a model that this build does not know.
  std::uint32_t unknown_models = 0;

  [[nodiscard]] const Introduction* introduction() const {
    return hello && hello->introduction ? &*hello->introduction : nullptr;
  }
};

}  // namespace peerd::replication
