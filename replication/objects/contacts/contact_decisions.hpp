#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/objects/contacts/contact_watch.hpp"
#include "replication/objects/contacts/decision.hpp"
#include "replication/objects/contacts/decision_log.hpp"
#include "replication/objects/contacts/resting_drives.hpp"
#include "replication/objects/replica/display.hpp"
#include "replication/objects/replica/own_objects.hpp"
#include "replication/objects/replica/owners.hpp"
#include "replication/objects/replica/replica.hpp"
#include "replication/objects/replica/scene_objects.hpp"
#include "replication/physics/world/motion_world.hpp"
#include "replication/session/membership.hpp"
#include "replication/settings/output/outbox.hpp"
#include "replication/settings/output/peer_counters.hpp"
#include "replication/settings/output/tick_grid.hpp"
#include "replication/settings/policy/peer_config.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// Contacts between objects of two owners, and of a scene object with an owner's: which peer decides each, what this
// peer decides, what it defers to another peer, and what becomes of decisions on their way to all (Ohlenburg 2003,
// section 4.4.4).
class ContactDecisions {
 public:
  // Called when the last decision in force on a scene object is that of `author` on a contact of that time.
  using OnDecided = std::function<void(ObjectId object, PeerId author, SimTime contact)>;

  // All arguments outlive this object. The display is given the contact times of decisions that take effect.
  ContactDecisions(const PeerConfig& config, const ModelInForce& model, Membership& members, const Owners& owners,
                   const SceneObjects& scene, OwnObjects& own, Replica& replica, Display& display,
                   const TickGrid& ticks, Outbox& outbox, PeerCounters& counters, OnDecided on_decided);

  // ---- the contacts that this peer looks for

  // Whether `peer` may be the one that decides a contact of two owners.
  [[nodiscard]] bool may_decide(PeerId peer, PeerId owner_a, PeerId owner_b) const;
  // The choice of the pairs that the truth and the ghosts watch.
  [[nodiscard]] ContactWatch& watch() { return watch_; }
  // The authority of a contact that the truth has found.
  [[nodiscard]] ContactAuthority authority(ObjectId a, ObjectId b, SimTime contact) const;
  // Whether the object is one of the scene that contacts move, and that nobody owns now.
  [[nodiscard]] bool is_free_scene_object(ObjectId object) const {
    return scene_.contains(object) && owners_.of(object) == kNobody;
  }

  // ---- contacts that this peer has found

  // The scene object of nobody's that the contact has moved; the collider of two. None: there is none.
  [[nodiscard]] std::optional<ObjectId> scene_object_moved(const ContactEvent& contact) const;
  // Decides, for all, a contact of two owners, or of an own object and such a scene object, that the truth has
  // answered.
  void decide(const ContactEvent& contact, SimTime known_at);
  // The ghosts have found a contact: a decision on it does not say the type of its interest.
  void note_found(const ContactEvent& contact);
  // Another peer is to decide the contact.
  void defer(const ContactEvent& contact);
  // At a tick: decides the deferred contacts on which nobody else has said anything in time (fallback).
  void resolve_overdue(SimTime t);
  [[nodiscard]] bool awaits_decision_on(ObjectId object) const;
  [[nodiscard]] bool has_deferred() const { return !deferred_.empty(); }

  // ---- what other peers say

  // Null, or why the decision changed nothing. Its contact is not later than `known_at`, which both worlds have
  // reached: a way that begins later has no contacts before that, so that it would take an object through a wall.
  [[nodiscard]] const char* on_decision(PeerId sender, std::uint32_t number, const DecisionRecord& decision,
                                        SimTime known_at);
  // The contact notes of a sender's hello: whether it has found the contacts that this peer leaves to it.
  void on_contact_notes(PeerId sender, const Hello& hello, SimTime known_at);
  // The datagrams of this peer that the sender has received: repeats at once a decision whose last copy has surely
  // been lost.
  void on_acknowledgement(PeerId sender, const Acknowledgement& acknowledgement);
  // The sender has begun a session: it knows of no decision.
  void on_new_session_of(PeerId sender);
  // The datagrams of this peer are numbered anew: what they have carried is not acknowledged by them any more.
  void forget_numbers();

  // An update that is kept (Replica), of any object, may say what drove it at a resting contact that has been decided,
  // or since: both worlds go on by that; of an own object, the ghosts.
  void on_drive(const UpdateRecord& update);

  // Whether one of the two is a scene object.
  [[nodiscard]] bool is_of_scene(const DecisionRecord& d) const;

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
  // The contact time of the last decision in force that says how the object moves: an update that does not know it is
  // of another way. What strikes a scene object without being moved itself goes on as its owner says. Contacts later
  // than `until` do not count; SimTime{}: there is none.
  [[nodiscard]] SimTime last_binding(ObjectId object, SimTime until = SimTime::max()) const;
  // Whether an update counts beside decisions the last of which is of `decided`. One that does not know them is of
  // another way, until its owner has surely never received them; and so is one that goes by an overruled decision.
  [[nodiscard]] bool counts(const UpdateRecord& update, SimTime decided) const;
  // Gives the ghosts the object's way from there on, by the decisions in force and the updates that count beside them.
  // The truth stays.
  void replay_ghost(ObjectId object, SimTime from) { replay(object, from, false); }
  // The contact time of the last decision on the object that this peer knows of; SimTime{}: none.
  [[nodiscard]] SimTime last_on(ObjectId object) const { return std::max(log_.last(object), scene_.decided(object)); }
  // Session time has stepped, and the worlds begin anew. Into another session: what was decided is void. Within the
  // same one the decisions stay known, so that none is applied again.
  void restart(bool same_session);
  // The object's owner has left or started anew: decisions on its contacts of before t concern no later life of it. One
  // that was only silent comes back with the life it had.
  void end_life_of(ObjectId object, SimTime t);
  // The object was taken for a scene object until t: what was decided on it is void.
  void forget(ObjectId object, SimTime t);

  // The object is no more: nothing is decided on it.
  void remove(ObjectId object);

  // The pose of a viewpoint's camera; none where the pose of its object at that time is not known.
  [[nodiscard]] std::optional<Pose> camera_pose(const Viewpoint& viewpoint, SimTime at) const;

 private:
  // A contact that this peer has found and another is to decide.
  struct Deferred {
    ContactEvent contact;
    PeerId decider;
  };

  [[nodiscard]] const char* why_void(const DecisionRecord& decision) const;
  [[nodiscard]] bool binds(const DecisionRecord& decision, PeerId author, ObjectId object) const;
  [[nodiscard]] bool may_have_decided(PeerId peer, const DecisionRecord& decision) const;
  [[nodiscard]] Duration lookback() const;
  [[nodiscard]] PeerId choose_decider(ObjectId a, ObjectId b, SimTime contact) const;
  [[nodiscard]] Contender contender(ObjectId object, SimTime at, std::span<const WorldBox> meeting) const;
  [[nodiscard]] bool may_have_missed_our_update(PeerId peer, const ContactEvent& contact) const;
  void decide_by_fallback(const ContactEvent& contact, SimTime known_at);
  [[nodiscard]] ContactEvent within_wire_limits(ContactEvent contact);
  [[nodiscard]] MotionModel outcome_in(const MotionWorld& world, ObjectId object, SimTime t,
                                       const KinematicState& after) const;
  [[nodiscard]] DecisionRecord record_of(const ContactEvent& contact, DecisionRule rule) const;
  std::vector<DecisionLog::Change> add_own(const DecisionRecord& record, CollisionType type);
  [[nodiscard]] CollisionType type_of(const DecisionRecord& decision, PeerId author) const;
  std::vector<ObjectId> name_owners(std::span<const DecisionLog::Change> changes) const;
  void apply(const std::vector<DecisionLog::Change>& changes, SimTime known_at);
  void apply(const DecisionRecord& decision, PeerId author, SimTime known_at);
  void rebase(ObjectId object, SimTime from);
  void lay_own_outcome(const DecisionLog::Entry& decision, ObjectId object, const KinematicState& after,
                       const std::optional<Rest>& rest);
  void replay(ObjectId object, SimTime from, bool in_truth);
  void repeat(DecisionLog::Entry& own);

  const PeerConfig& config_;
  const ModelInForce& model_;
  Membership& members_;
  const Owners& owners_;
  const SceneObjects& scene_;
  OwnObjects& own_;
  Replica& replica_;
  ContactWatch watch_;
  RestingDrives drives_;
  Display& display_;
  const TickGrid& ticks_;
  Outbox& outbox_;
  PeerCounters& counters_;
  OnDecided on_decided_;
  DecisionLog log_;
  std::vector<Deferred> deferred_;
  // The last contact that was found of each interest, of pairs with several; by the lower and the higher object.
  std::map<std::tuple<ObjectId, ObjectId, CollisionType>, SimTime> last_found_;
  std::map<ObjectId, SimTime> life_since_;  // of objects whose owner has left once
};

}  // namespace peerd::replication
