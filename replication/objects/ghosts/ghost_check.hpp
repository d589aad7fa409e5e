#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/objects/contacts/contact_decisions.hpp"
#include "replication/objects/ghosts/ghost_digest.hpp"
#include "replication/objects/regions/region_subscriptions.hpp"
#include "replication/objects/replica/own_objects.hpp"
#include "replication/objects/replica/owners.hpp"
#include "replication/objects/replica/replica.hpp"
#include "replication/objects/replica/scene_objects.hpp"
#include "replication/objects/sight/sight.hpp"
#include "replication/session/membership.hpp"
#include "replication/settings/output/outbox.hpp"
#include "replication/settings/output/peer_counters.hpp"
#include "replication/settings/policy/peer_config.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// Peers check each other: where an owner believes that its objects are shown is where each receiver shows them, or both
// notice.
//
// A digest of an owner's ghosts at a recent instant goes with a datagram that goes anyway. A receiver that computes
// another one asks the owner about that group of objects, by digests of smaller groups (buckets). The owner answers
// with the states of the objects in the buckets that differ, and publishes them anew. The receiver compares each state
// with its own ghost, counts and outputs what differs, and reports the distance to the owner.
//
// Scene objects that a contact has lent are left out: until a decision comes, each peer predicts them by itself, and
// SceneKeeper compares where they come to lie.
//
// A difference is explained where this peer cannot have known better: a datagram was lost lately, the last update or
// decision of the object has not come yet, or the scene is cut, so that the two peers predict contacts with different
// objects. Any other difference is an error of the program. Peers that have only just met have not exchanged all states
// yet, and compare nothing.
class GhostCheck {
 public:
  // All arguments outlive this object.
  GhostCheck(const PeerConfig& config, Membership& members, const Owners& owners, const SceneObjects& scene,
             OwnObjects& own, Replica& replica, const Sight& sight, RegionSubscriptions& regions,
             const ContactDecisions& decisions, Outbox& outbox, PeerCounters& counters);

  // At a tick: a digest that is due goes with the next datagram to its region.
  void on_tick(SimTime t);

  // ---- what other peers say; `now`: session time

  void on_digest(PeerId sender, RegionId region, const GhostDigest& digest, SimTime now);
  void on_question(PeerId sender, const GhostQuestion& question, SimTime now);
  void on_answer(PeerId sender, const GhostAnswer& answer, SimTime now);
  void on_reports(PeerId sender, std::span<const GhostReport> reports, SimTime now);

  // How far apart this peer and another one have lately shown the object, or an own object and a receiver [m]; none: no
  // difference is known.
  [[nodiscard]] std::optional<double> difference_m(ObjectId object, SimTime now) const;

 private:
  // The sums of one owner's objects; of those in a region where the scene is cut.
  using Sums = std::map<std::pair<PeerId, RegionId>, GhostSums>;
  struct Difference {
    double distance_m;
    SimTime noticed, at;  // at: the instant at which they differed, as far as this peer knows it
  };

  // The last questions to an owner: when they went, of which instant, and how long the next ones wait.
  struct Asked {
    SimTime when, instant;
    Duration wait;
  };
  // Answers about a group: the last one, and to whom within kAnsweredApart. Objects for which an answer has no room
  // take turns.
  struct Answered {
    std::optional<SimTime> last;
    std::map<PeerId, SimTime> peers;
    std::size_t turn = 0;
  };
  // The first and the last one of the digests of an owner that have come without a long pause, and when this peer last
  // computed its own for one of them.
  struct Digests {
    SimTime first, last;
    SimTime computed = SimTime::min();
  };

  [[nodiscard]] bool knows_ghosts_at(SimTime t) const;
  [[nodiscard]] const Sums& sums_at(SimTime t);
  [[nodiscard]] Duration digest_age() const;
  [[nodiscard]] Duration digests_apart() const;
  [[nodiscard]] Digests& note_digest(PeerId owner, RegionId region, SimTime t);
  void forget_old(SimTime t);
  [[nodiscard]] bool is_on_its_way(const OwnObject& own, PeerId receiver, SimTime now) const;
  [[nodiscard]] bool has_lost_datagrams() const;
  [[nodiscard]] bool is_explained(PeerId owner, const UpdateRecord& state) const;
  void send(Message& message);

  const PeerConfig& config_;
  Membership& members_;
  const Owners& owners_;
  const SceneObjects& scene_;
  OwnObjects& own_;
  Replica& replica_;
  const Sight& sight_;
  RegionSubscriptions& regions_;
  const ContactDecisions& decisions_;
  Outbox& outbox_;
  PeerCounters& counters_;
  std::optional<SimTime> sums_of_;  // the instant of `sums_`
  std::uint64_t life_ = 0;          // of the worlds that `sums_` and `digested_` are of
  Sums sums_;
  SimTime checked_ = SimTime::min();   // when this peer last checked whether a digest is due
  std::uint64_t withheld_ = 0;         // updates, until then (PeerCounters)
  SimTime digested_ = SimTime::min();  // the instant of the last digest of this peer
  std::map<PeerId, Asked> asked_;
  std::array<Answered, kGhostGroups> answered_{};
  std::map<std::pair<PeerId, RegionId>, Digests> received_;
  std::map<ObjectId, Difference> differences_;
};

}  // namespace peerd::replication
