#pragma once
#include <optional>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/objects/replica/owners.hpp"
#include "replication/objects/replica/replica.hpp"
#include "replication/session/membership.hpp"
#include "replication/settings/output/peer_counters.hpp"
#include "replication/settings/output/tick_grid.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// Whether what a decision says of others' objects can be, by all that this peer knows. Its sender may be the decider of
// the pair and still lie: without this, one decision puts an object anywhere.
//
// The bounds are far wider than what honest peers may differ by, whatever the latency, so that no peer refuses what
// others take. A peer that has not received yet why an object is where it is refuses too; it says that the datagram is
// missing, and takes the decision when it is repeated. What the sender owns is its own: its way is not checked.
class DecisionCheck {
 public:
  // The longest time over which two peers' knowledge of a motion may differ: the age up to which decisions are taken,
  // and a latency.
  static constexpr Duration kKnowledgeDiffers = std::chrono::seconds(8);
  // A peer that has just come, or whose object it is, may not know yet where things are.
  static constexpr Duration kSettling = std::chrono::seconds(10);
  // Two objects that meet are no farther apart [m] than their extents, besides this; and an object is no farther from
  // where this peer believes it than it moves in kKnowledgeDiffers, besides that.
  static constexpr double kApart_m = 1.0, kElsewhere_m = 20.0;
  // No response multiplies the speeds [m/s] of the two that meet by so much, and this is added for what comes of rest.
  static constexpr double kSpeedGrows = 4.0, kSpeedSlack_m_s = 100.0;

  // All arguments outlive this object.
  DecisionCheck(const ModelInForce& model, const Membership& members, const Owners& owners, Replica& replica,
                const TickGrid& ticks)
      : model_(model), members_(members), owners_(owners), replica_(replica), ticks_(ticks) {}

  // The limit that the decision breaks; none: what it says can be. The pair is of the model, and the replica has begun.
  [[nodiscard]] std::optional<MemberLimit> broken_by(HostTime now, PeerId sender, const DecisionRecord& decision) const;

 private:
  // The places of an object around the contact time, and its speed, as this peer believes them.
  struct Belief;

  [[nodiscard]] bool knows(HostTime now, ObjectId object) const;
  [[nodiscard]] Belief belief(ObjectId object, SimTime contact) const;
  [[nodiscard]] double extent_m(ObjectId object) const;

  const ModelInForce& model_;
  const Membership& members_;
  const Owners& owners_;
  Replica& replica_;
  const TickGrid& ticks_;
};

}  // namespace peerd::replication
