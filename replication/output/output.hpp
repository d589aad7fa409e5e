#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/motion/colliding_objects.hpp"
#include "replication/motion/motion_world.hpp"
#include "replication/policy/publish_policy.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// What a peer puts out, to be drained by Peer::poll_output() after every call that takes a time.

// Its datagrams mean other things by the same numbers. Told once a version.
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
  PeerId follows;  // itself: it founded the session
  Duration session_minus_host, error_bound;
};
// Session time went forward at once: into another session's, or, after a sleep, to where the same one had got.
struct ClockStepped {
  Duration session_minus_host, step;
  bool same_session;
};
// Two operating systems' clocks cannot both be as good as they say: what the hellos' stamps say is believed.
struct OsClockDoubted {
  PeerId peer;
  Duration apart;  // of what they say and what the stamps allow
};
struct HostSuspended {
  Duration gap;  // this peer was not run for so long; its objects go on from where they were
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
struct IdInUse {
  PeerId peer;  // our own id, heard from somebody else
};
struct OwnershipConflict {
  ObjectId object;
  PeerId owner;  // who keeps it: the lower id
};
struct Published {
  SimTime at;
  ObjectId object;
  std::size_t size_bytes;
  double threshold_m;
  PublishReason reason;
};
enum class ContactKind : std::uint8_t {
  kOwner,      // happened to an object that this peer runs
  kDecided,    // between an object of its own and another peer's; this peer decided and told the others
  kPredicted,  // on ghosts: remote collision prediction
  kApplied,    // another peer's decision
};
// A decision that was made or applied here counts no more: another on the same collision does.
struct Overruled {
  ObjectId collider, collidee;
  SimTime contact;
};
struct ContactSeen {
  ContactKind kind;
  ContactEvent contact;
  SimTime known_at;
};
using Output = std::variant<Send, Join, Leave, Synchronised, ClockStepped, OsClockDoubted, HostSuspended, PeerJoined, PeerLost,
                            ObjectOrphaned, OtherVersion, OtherWorld, IdInUse, OwnershipConflict, Published, ContactSeen,
                            Overruled, ContactsRetracted, NotColliding>;

}  // namespace peerd::replication
