#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "core/ids.hpp"
#include "core/time.hpp"

namespace peerd::replication {

// The limits of the classes of record sizes that the counters distinguish [bytes].
inline constexpr std::array<std::size_t, 4> kRecordSizes{16, 24, 32, 64};

// Why a datagram, or a record in it, was not used.
enum class Drop : std::uint8_t {
  kOwn,               // multicast loopback brings back what this peer sent
  kUndecodable,       // not a datagram by codec.hpp
  kIdInUse,           // the id of this peer with another incarnation
  kStaleIncarnation,  // sent before that peer's restart
  kOtherWorld,
  kOtherLine,
  kTooMany,          // more peers than one network carries
  kUnintroduced,     // no introduction of that peer has come yet
  kNotYetInSession,  // this peer has no session time yet
  kIdentityCheck,    // a question whether a peer is alive, or its answer
  kRegion,           // sent to one region, although it concerns all peers
  kMemberLimit,      // more datagrams or starts of one member than are taken (MemberLimit)
};
[[nodiscard]] const char* to_string(Drop);

// The limits of what one member can do to the others (session/member_limits.hpp). The name of a limit is the reason
// under which what goes beyond is counted.
enum class MemberLimit : std::uint8_t {
  kClockAhead,          // its session time is farther ahead than this peer follows anybody
  kStampAhead,          // updates or decisions of the future, by its own clock too
  kOperationAhead,      // operations of the future, which wait for their time
  kDecisionImpossible,  // a decision on what cannot have met, or that makes objects faster than they can be
  kDecisionElsewhere,   // a decision on others' objects where these are not
  kDatagrams,           // datagrams
  kDecisions,           // decisions
  kClaims,              // objects that it takes from others by its introduction
  kOperations,          // bytes of operations
  kLogLength,           // operations of one author, or of all authors together, that are too long to hold
  kAuthors,             // authors of operations of which nothing has come
  kRequests,            // ranges of operations that it asks others for
  kResends,             // times that it makes others publish anew what they own
  kSubscriptions,       // regions that it listens to anew
  kRestarts,            // starts
};
[[nodiscard]] const char* to_string(MemberLimit);

// A received datagram counts as the first of these that it has.
enum class DatagramKind : std::uint8_t {
  kFarHello,  // of a large session
  kHello,
  kDecisions,
  kSubscriptions,
  kSceneStates,
  kOperations,
  kHandovers,
  kUpdates,
  kKeepalive,
};
inline constexpr std::size_t kDatagramKinds = static_cast<std::size_t>(DatagramKind::kKeepalive) + 1;
[[nodiscard]] const char* to_string(DatagramKind);

// The counters of what one peer has done since it was made.
struct PeerCounters {
  std::uint64_t datagrams_in = 0, datagrams_out = 0, bytes_in = 0, bytes_out = 0;
  std::map<std::string, std::uint64_t> drops;  // by reason
  std::uint64_t ticks = 0, ticks_missed = 0;
  std::uint64_t updates_in = 0, updates_out = 0;
  std::uint64_t updates_at_once = 0;   // the part of updates_out that was sent between two ticks
  std::uint64_t update_bytes_out = 0;  // of updates_out
  // The number of updates_out that fit each of kRecordSizes, then that of longer ones.
  std::array<std::uint64_t, kRecordSizes.size() + 1> update_sizes_out{};
  std::uint64_t updates_repeated = 0;   // second copies sent; not in updates_out
  std::uint64_t operations = 0;         // made by this peer
  std::uint64_t operations_in = 0;      // received from others
  std::uint64_t scene_changes = 0;      // times that edits changed the scene
  std::uint64_t objects_given = 0;      // times that operations gave an object to another peer, or to nobody
  std::uint64_t models_changed = 0;     // times that the world's model was made anew, because more of it moves
  std::uint64_t updates_duplicate = 0;  // copies of updates that were applied already
  // Digests of ghosts that this peer has compared, questions that it has asked, and answers that it has given.
  std::uint64_t ghost_checks = 0, ghost_questions = 0, ghost_answers = 0;
  // How often this peer has shown an object elsewhere than its owner believed: without and with a known reason.
  std::uint64_t ghosts_differ = 0, ghosts_differ_explained = 0;
  std::uint64_t ghosts_reported = 0;  // times that another peer has shown an own object elsewhere
  std::uint64_t records_early = 0;    // records that waited until this peer had reached their instant
  std::uint64_t updates_relayed = 0;
  std::uint64_t updates_withheld = 0;     // due, but beyond the byte budget; counted at each tick
  std::uint64_t states_out_of_range = 0;  // states that were replaced by rest, for receivers would refuse them
  std::uint64_t convergence_blocked = 0;  // ways of displayed objects that would have led through something
  std::uint64_t convergence_detours = 0;  // ways that followed the ghost's own way instead
  std::uint64_t objects_looked_at = 0;    // own objects checked, at each tick; resting ones need not be
  std::uint64_t proximity_tests = 0;
  std::uint64_t proximity_refined = 0;                 // tests that bounding spheres did not settle
  std::uint64_t decisions = 0;                         // decisions of this peer, those by fallback included
  std::uint64_t decisions_fallback = 0;                // decisions because no other peer had decided
  std::uint64_t decisions_repeated = 0;                // copies sent after the first ones
  std::uint64_t decisions_overruled = 0;               // known decisions that are no longer in force
  std::uint64_t contacts_held = 0;                     // contacts that another peer is to decide
  std::uint64_t contacts_refuted = 0;                  // deferred contacts that the other peer did not find
  std::uint64_t contacts_too_late = 0;                 // contacts that were found so late that nobody decides them
  std::uint64_t regions_joined = 0, regions_left = 0;  // without kWholeScene
  std::uint64_t handovers = 0;                         // updates of an object in another region than its last one
  std::uint64_t sights_lost = 0;                       // objects that this peer ceased to receive
  std::uint64_t predictions_skipped = 0;  // pairs without prediction, because one object is not received; at each tick
  std::uint64_t predictions_unseen = 0;   // part pairs of ghosts that were put off, as nobody sees them; at each tick
  // Counts of BoundedLatency: updates and decisions that came at their stamp + the bound or later, when something else
  // had been shown already, and the most by which one did; and updates in whose place a newer one came.
  std::uint64_t updates_late = 0, updates_missing = 0, decisions_late = 0;
  Duration latest_by{0};
  // The traffic of a region: datagrams received and used, datagrams dropped by reason, datagrams sent.
  struct Traffic {
    std::uint64_t datagrams_in = 0, bytes_in = 0, datagrams_out = 0, bytes_out = 0;
    std::map<std::string, std::uint64_t> drops;
  };
  std::map<RegionId, Traffic> regions;
  struct Volume {
    std::uint64_t datagrams = 0, bytes = 0;
  };
  std::array<Volume, kDatagramKinds> kinds_in{};  // of datagrams that were used, by DatagramKind
  std::uint64_t clock_steps = 0;                  // steps of session time
  std::uint64_t clock_contradictions = 0;         // stamps that cannot be true together, because some clock jumped
  std::uint64_t os_clocks_doubted = 0;            // pairs of OS clocks that contradict the stamps
};

}  // namespace peerd::replication
