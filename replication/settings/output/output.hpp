#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/physics/world/colliding_objects.hpp"
#include "replication/physics/world/motion_world.hpp"
#include "replication/settings/output/peer_counters.hpp"
#include "replication/settings/policy/publish_policy.hpp"
#include "replication/wire/operation.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// The outputs of a peer, to be drained by Peer::poll_output() after every call that takes a time.

// A peer of another protocol version, whose datagrams mean other things by the same numbers. Each version is reported
// once.
struct OtherVersion {
  PeerId peer;
  std::uint32_t version = 0;
};

struct Send {
  RegionId region;
  Bytes datagram;
};
struct Join {
  RegionId region;
};
struct Leave {
  RegionId region;
};
struct Synchronised {
  PeerId follows;  // the followed peer; itself: it founded the session
  Duration session_minus_host, error_bound;
};
// Session time stepped forward: into another session's, or, after a suspension, to where the same one had got.
struct ClockStepped {
  Duration session_minus_host, step;
  bool same_session;
};
// Two operating systems' clocks cannot both be as good as they say: the stamps of the hellos are believed.
struct OsClockDoubted {
  PeerId peer;
  Duration apart;  // the gap between the bounds by the clocks and the bounds by the stamps
};
struct HostSuspended {
  Duration gap;  // this peer did not run for so long; its objects go on from where they were
};
struct PeerJoined {
  PeerId peer;
  std::string name;
  bool restarted;
};
struct PeerLost {
  PeerId peer;
  std::string name;
  bool left_gracefully;
};
struct ObjectOrphaned {
  ObjectId object;
  PeerId owner;
};
struct OtherWorld {
  PeerId peer;
  std::string name;
};
// This peer has no edits, and is of the line of descent of that peer's from now on.
struct LineTaken {
  PeerId from;
  std::uint64_t line = 0;
};
// A peer's edits descend by another line than this peer's (replication::LineOfDescent), so that nothing of it is used.
struct OtherLine {
  PeerId peer;
  std::string name;
  std::uint64_t line = 0;
  bool goes_over = false;  // this peer is new, and must begin anew with that line; else both stay apart
};
// Two programs are peers of one id. What the one says that started earlier, others drop.
struct IdInUse {
  PeerId peer;            // the id
  bool is_ours;           // this peer is one of the two
  bool ours_is_replaced;  // and the other one started later
};
// Two peers, one of which may be this one, have one name: people and scripts can't tell them apart.
struct NameInUse {
  PeerId peer, other;
  std::string name;
};
// A member has met a limit of what one member can do to the others. Said once a minute of each member and limit.
struct LimitMet {
  PeerId peer;
  MemberLimit limit;
  std::uint64_t times = 0;  // since it was last said
};
struct OwnershipConflict {
  ObjectId object;
  PeerId owner;  // the peer that keeps the object: the one with the lower id
};
// The founder of the session has had an object by the world's file, and gives way to a peer whose settings own it.
struct FounderGaveWay {
  ObjectId object;
  PeerId founder, owner;
};
// An operation has taken its place among all others, or what comes before it is another now. From `at` on the scene is
// what they make.
struct SceneEdited {
  OperationId operation;
  SimTime at;
  std::string refused;  // why it changes nothing; empty: it does what it says
};
// An application's value at a node is another from now on, or is gone, also with its node.
struct DataChanged {
  NodeId node;
  std::string key;
  std::optional<std::string> value;  // none: the key is gone
  SimTime at;
};
// A peer, which may be this one, has sent this to all.
struct MessageReceived {
  OperationId operation;
  PeerId by;
  std::string topic, text;
  SimTime at;
};
// Another peer has this peer's operation, which is not lost any more with this peer.
struct OperationHeld {
  OperationId operation;
};
// An operation has given the object to another peer; kNobody: nobody has it, or who has it is not here.
struct ObjectGiven {
  ObjectId object;
  PeerId before, owner;
  SimTime at;
};
// Another peer asks this one for an object that this one owns.
struct ObjectRequested {
  OperationId request;
  ObjectId object;
  PeerId by;
};
// The owner refuses what this peer has asked for.
struct RequestRefused {
  OperationId request;
  std::string reason;
};
// A log, this peer's own or another author's, has grown by whole operations: Peer::log_bytes() has them. It comes
// before whatever this peer sends of them, so that a driver with a store writes them before anybody can have them.
struct LogGrown {
  OperationRange range;
  OperationId last;  // the last operation in it
};
// This peer shows all objects as they were so long ago, its own too, from now on (BoundedLatency).
struct DelayShown {
  Duration delay;
};
// Some have come too late to be shown in time (BoundedLatency). Said at most once in kLateSaidEvery.
struct CameTooLate {
  std::uint64_t updates = 0, missing = 0, decisions = 0;  // since it was last said (PeerCounters)
  Duration latest_by{0};                                  // ever
};
inline constexpr Duration kLateSaidEvery = std::chrono::seconds(10);
struct Published {
  SimTime at;
  ObjectId object;
  std::size_t size_bytes;
  double threshold_m;
  PublishReason reason;
};
enum class ContactKind : std::uint8_t {
  kOwner,      // a contact of an object that this peer owns
  kDecided,    // between objects of two owners; this peer has decided it and publishes the decision
  kPredicted,  // a contact of ghosts: remote collision prediction
  kApplied,    // another peer's decision
  kScene,      // of what nobody owns: every peer finds it by itself
};
// A decision that was made or applied here is no longer in force: another one on the same collision is.
struct Overruled {
  ObjectId collider, collidee;
  SimTime contact;
};
struct ContactSeen {
  ContactKind kind;
  ContactEvent contact;
  SimTime known_at;
  PeerId decider = kNobody;  // whose finding or decision it is; nobody's: kPredicted and kScene
};
// A peer shows an object elsewhere than its owner believes; said by both.
struct GhostDiffers {
  ObjectId object;
  PeerId owner, by;  // `by` shows it elsewhere
  SimTime at{};
  double distance_m = 0.0;
  bool explained = false;  // by what has been lost, or has not come yet; the owner does not ask for the reason
};
using Output =
    std::variant<Send, Join, Leave, Synchronised, ClockStepped, OsClockDoubted, HostSuspended, PeerJoined, PeerLost,
                 ObjectOrphaned, OtherVersion, OtherWorld, LineTaken, OtherLine, IdInUse, NameInUse, LimitMet,
                 OwnershipConflict, FounderGaveWay, SceneEdited, DataChanged, MessageReceived, OperationHeld,
                 ObjectGiven, ObjectRequested, RequestRefused, LogGrown, DelayShown, CameTooLate, Published,
                 ContactSeen, Overruled, ContactsRetracted, BodiesOverlap, NotColliding, GhostDiffers>;

}  // namespace peerd::replication
