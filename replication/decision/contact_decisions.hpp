#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/decision/decision.hpp"
#include "replication/decision/decision_log.hpp"
#include "replication/output/outbox.hpp"
#include "replication/output/peer_counters.hpp"
#include "replication/output/tick_grid.hpp"
#include "replication/policy/peer_config.hpp"
#include "replication/replica/own_objects.hpp"
#include "replication/replica/owners.hpp"
#include "replication/replica/replica.hpp"
#include "replication/session/membership.hpp"
#include "replication/wire/wire.hpp"
#include "replication/world/motion_world.hpp"

namespace peerd::replication {

// Contacts between objects of two owners: which peer decides each, what this peer decides, what it defers to another
// peer, and what becomes of decisions on their way to all (Ohlenburg 2003, section 4.4.4).
class ContactDecisions {
 public:
  // All arguments outlive this object.
  ContactDecisions(const PeerConfig& config, const ModelInForce& model, Membership& members, const Owners& owners,
                   OwnObjects& own, Replica& replica, const TickGrid& ticks, Outbox& outbox, PeerCounters& counters);

  // ---- the contacts that this peer looks for

  // Whether `peer` may be the one that decides a contact of two owners.
  [[nodiscard]] bool may_decide(PeerId peer, PeerId owner_a, PeerId owner_b) const;
  // Makes the truth and the ghosts watch these pairs of the model from now on, or not, by who owns and receives their
  // objects. Does nothing before the replica has begun.
  void watch(std::span<const std::uint32_t> pairs);
  // The authority of a contact that the truth has found.
  [[nodiscard]] ContactAuthority authority(ObjectId a, ObjectId b, SimTime contact) const;

  // ---- contacts that this peer has found

  // Decides, for all, a contact of two owners that the truth has answered.
  void decide(const ContactEvent& contact, SimTime known_at);
  // The ghosts have found a contact: a decision on it does not say the type of its interest.
  void note_found(const ContactEvent& contact);
  // Another peer is to decide the contact.
  void defer(const ContactEvent& contact);
  // At a tick: applies the decisions whose time has come, and decides the deferred contacts on which nobody else has
  // said anything in time (fallback).
  void resolve_overdue(SimTime t);
  [[nodiscard]] bool awaits_decision_on(ObjectId object) const;
  [[nodiscard]] bool has_deferred() const { return !deferred_.empty(); }

  // ---- what other peers say

  // Null, or why the decision changed nothing.
  [[nodiscard]] const char* on_decision(PeerId sender, std::uint32_t number, const DecisionRecord& decision,
                                        SimTime known_at);
  // The contact notes of a sender's hello: whether it has found the contacts that this peer leaves to it.
  void on_contact_notes(PeerId sender, const Hello& hello, SimTime known_at);
  // The datagrams of this peer that the sender has received: repeats at once a decision whose last copy has surely
  // been lost.
  void on_acknowledgement(PeerId sender, const Acknowledgement& acknowledgement);
  // The sender has begun a session: it knows of no decision.
  void on_new_session_of(PeerId sender);

  // ---- what goes out

  // The caller calls it with each hello: it repeats decisions that every peer of the session could have confirmed, and
  // some peer has not.
  void repeat_unacknowledged();
  // For a hello: the contacts that this peer defers, and its own decisions until all peers have them. A peer that
  // defers the same contact waits for the decision.
  [[nodiscard]] std::vector<ContactNote> notes() const;
  // The decisions of which a copy is due, for a datagram; the caller counts each one down.
  [[nodiscard]] std::vector<DecisionLog::Entry>& entries() { return log_.entries(); }
  // Own decisions went out with the datagram of that number.
  void note_sent(std::span<const DecisionRecord> decisions, std::uint32_t number);

  [[nodiscard]] const DecisionLog& log() const { return log_; }
  // Session time has stepped, and the worlds begin anew. Into another session: what was decided is void. Within the
  // same one the decisions stay known, so that none is applied again.
  void restart(bool same_session);
  // The object's owner has left or started anew: decisions on its contacts of before t concern no later life of it. One
  // that was only silent comes back with the life it had.
  void end_life_of(ObjectId object, SimTime t) { life_since_[object] = t; }

  // The pose of a viewpoint's camera; none where the pose of its object at that time is not known.
  [[nodiscard]] std::optional<Pose> camera_pose(const Viewpoint& viewpoint, SimTime at) const;

 private:
  // A contact that this peer has found and another is to decide.
  struct Deferred {
    ContactEvent contact;
    PeerId decider;
  };

  // A decision whose time has not come here: its author's clock is ahead.
  struct Early {
    DecisionRecord decision;
    PeerId author;
  };

  [[nodiscard]] const char* why_void(const DecisionRecord& decision) const;
  void apply_early(SimTime t);
  [[nodiscard]] bool searches_contacts_of(ObjectId a, ObjectId b) const;
  [[nodiscard]] Duration lookback() const;
  [[nodiscard]] WorldBox box_of_end(ObjectId object, SimTime at) const;
  [[nodiscard]] PeerId choose_decider(ObjectId a, ObjectId b, SimTime contact) const;
  [[nodiscard]] Contender contender(ObjectId object, SimTime at, std::span<const WorldBox> meeting) const;
  [[nodiscard]] bool reaches_all_in_time(SimTime contact) const;
  [[nodiscard]] bool may_have_missed_our_update(PeerId peer, const ContactEvent& contact) const;
  void decide_by_fallback(const ContactEvent& contact, SimTime known_at);
  [[nodiscard]] ContactEvent within_wire_limits(ContactEvent contact);
  [[nodiscard]] MotionModel outcome_in(const MotionWorld& world, ObjectId object, SimTime t,
                                       const KinematicState& after) const;
  [[nodiscard]] DecisionRecord record_of(const ContactEvent& contact, DecisionRule rule) const;
  std::vector<DecisionLog::Change> add_own(const DecisionRecord& record, CollisionType type);
  [[nodiscard]] CollisionType type_of(const DecisionRecord& decision, PeerId author) const;
  void apply(const std::vector<DecisionLog::Change>& changes, SimTime known_at);
  void apply(const DecisionRecord& decision, PeerId author, SimTime known_at);
  void rebase(ObjectId object, SimTime from);
  void repeat(DecisionLog::Entry& own);
  [[nodiscard]] bool is_acknowledged_by_all(const DecisionLog::Entry& own) const;

  const PeerConfig& config_;
  const ModelInForce& model_;
  Membership& members_;
  const Owners& owners_;
  OwnObjects& own_;
  Replica& replica_;
  const TickGrid& ticks_;
  Outbox& outbox_;
  PeerCounters& counters_;
  DecisionLog log_;
  std::vector<Deferred> deferred_;
  std::vector<Early> early_;
  // The last contact that was found of each interest, of pairs with several; by the lower and the higher object.
  std::map<std::tuple<ObjectId, ObjectId, CollisionType>, SimTime> last_found_;
  std::map<ObjectId, SimTime> life_since_;  // of objects whose owner has left once
};

}  // namespace peerd::replication
