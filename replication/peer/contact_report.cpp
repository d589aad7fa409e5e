#include "replication/peer/contact_report.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <variant>
#include <vector>

namespace peerd::replication {
namespace {

// An object that is squeezed between two others touches each of them many times a millisecond. Contacts of one pair no
// farther apart are one touch, and the last of them is what becomes of it.
constexpr Duration kSameTouch = std::chrono::milliseconds(4);

// Each interest in a pair that nobody answers has contacts of its own.
bool is_same_touch(const WorldModel& model, const ContactEvent& a, const ContactEvent& b) {
  const bool pair =
      (a.collider == b.collider && a.collidee == b.collidee) || (a.collider == b.collidee && a.collidee == b.collider);
  if (pair && a.type != b.type && !model.is_answered(a.collider, a.collidee)) return false;
  return pair && a.at <= b.at + kSameTouch && b.at <= a.at + kSameTouch;
}

// NewEvents holds the events of one world since the last tick.
struct NewEvents {
  std::vector<ContactsRetracted> retracted;  // of earlier ticks' contacts; each object and partner once
  std::vector<MotionWorld::Event> others;    // contacts and overlaps, as they were found
};

// After a decision of the past a world goes through all that followed again, and again after the next one. A contact
// that a later event retracts is left out.
NewEvents poll_standing_events(MotionWorld& world) {
  std::vector<MotionWorld::Event> events;
  while (auto event = world.poll_event()) events.push_back(*std::move(event));
  std::map<std::pair<ObjectId, std::optional<ObjectId>>, SimTime> since;  // the earliest retraction by later events
  const auto is_retracted = [&](const ContactEvent& c) {
    const auto by = [&](ObjectId object, std::optional<ObjectId> partner) {
      const auto at = since.find({object, partner});
      return at != since.end() && ContactsRetracted{object, at->second, partner}.retracts(c.at, c.collider, c.collidee);
    };
    return by(c.collider, {}) || by(c.collidee, {}) || by(c.collider, c.collidee) || by(c.collidee, c.collider);
  };
  NewEvents standing;
  for (auto event = events.rbegin(); event != events.rend(); ++event) {
    if (const auto* retracted = std::get_if<ContactsRetracted>(&*event)) {
      const auto [known, added] = since.try_emplace({retracted->object, retracted->partner}, retracted->since);
      known->second = std::min(known->second, retracted->since);
      continue;
    }
    const auto* contact = std::get_if<ContactEvent>(&*event);
    if (contact == nullptr || !is_retracted(*contact)) standing.others.push_back(std::move(*event));
  }
  std::ranges::reverse(standing.others);
  for (const auto& [of, t] : since) standing.retracted.push_back({of.first, t, of.second});
  return standing;
}

// Scene objects have met: every peer finds that, and the file does not move them any more.
void note_scene_contact(PeerParts& p, const ContactEvent& contact) {
  for (const ObjectId object : {contact.collider, contact.collidee}) {
    if (changes_motion_of(object, contact) && p.scene.contains(object)) p.scene.note_moved(object);
  }
}

void note_retraction(PeerParts& p, ObjectId object, SimTime t) {
  if (!p.scene.is_moved(object) || p.owners.of(object) != kNobody) return;
  if (!p.replica.truth().is_moved_by_contact(object, t)) p.scene.note_unmoved(object);
}

// An edit has taken an end away since they met, and its polygons with it. Nobody decides such a contact any more.
bool is_gone(const WorldModel& model, const ContactEvent& contact) {
  return std::ranges::any_of(std::array{contact.collider, contact.collidee},
                             [&](ObjectId id) { return !model.scene->contains(id) || model.node(id) == nullptr; });
}

// Reports contacts of own objects; as the server, those of all objects.
void report_truth(PeerParts& p, SimTime t) {
  std::vector<ContactEvent> decided;  // in order of time, the last contact of each touch
  std::set<ObjectId> adopted;         // by these decisions
  const auto is_ours = [&](ObjectId id) { return p.own.contains(id) || adopted.contains(id); };
  const NewEvents events = poll_standing_events(p.replica.truth());
  for (const ContactsRetracted& each : events.retracted) note_retraction(p, each.object, t);
  for (const MotionWorld::Event& event : events.others) {
    if (const auto* overlap = std::get_if<BodiesOverlap>(&event)) {
      if (p.own.contains(overlap->collider) || p.own.contains(overlap->collidee)) p.outbox.push(*overlap);
      continue;
    }
    const auto* contact = std::get_if<ContactEvent>(&event);
    if (contact == nullptr) continue;
    const bool mine = is_ours(contact->collider) || is_ours(contact->collidee);
    if (is_gone(*p.model, *contact)) {
      if (mine) p.outbox.push(ContactSeen{ContactKind::kOwner, *contact, t, p.config.id});
      continue;
    }
    const bool both = is_ours(contact->collider) && is_ours(contact->collidee);
    const auto moved = both ? std::nullopt : p.decisions.scene_object_moved(*contact);
    if (moved && mine && !contact->deferred) adopted.insert(*moved);
    if (moved && !mine) note_scene_contact(p, *contact);
    const bool shared = p.owners.have_two(contact->collider, contact->collidee) || (moved && mine);
    if (!mine && !(shared && p.config.is_decision_server())) continue;  // a partner's own contact, which ghosts show
    if (shared) {
      if (contact->deferred) {
        p.decisions.defer(*contact);
      } else {
        std::erase_if(decided, [&](const ContactEvent& c) { return is_same_touch(*p.model, c, *contact); });
        decided.push_back(*contact);
      }
      continue;
    }
    p.replica.colliding().on_contact(*contact);
    ContactEvent named = *contact;
    p.replica.name_polygons(named, true);
    p.outbox.push(ContactSeen{ContactKind::kOwner, std::move(named), t, p.config.id});
  }
  for (const ContactEvent& contact : decided) p.decisions.decide(contact, t);
  p.decisions.resolve_overdue(t);
}

// Reports contacts that all peers predict, and those of what nobody owns. Contacts of own objects are reported by the
// truth, or by a decision.
void report_ghosts(PeerParts& p, SimTime t) {
  const auto is_remote = [&](ObjectId id) { return !p.own.contains(id) && p.owners.of(id) != kNobody; };
  NewEvents events = poll_standing_events(p.replica.ghosts());
  for (ContactsRetracted& each : events.retracted) {
    each.of_ghosts_alone = p.owners.of(each.object) == kNobody;
    if (each.of_ghosts_alone || is_remote(each.object)) p.outbox.push(each);
  }
  for (MotionWorld::Event& event : events.others) {
    if (std::holds_alternative<BodiesOverlap>(event)) continue;  // their owners name it
    auto& contact = std::get<ContactEvent>(event);
    if (is_gone(*p.model, contact)) {
      const bool was_remote = is_remote(contact.collider) || is_remote(contact.collidee);
      if (was_remote) p.outbox.push(ContactSeen{ContactKind::kPredicted, std::move(contact), t});
      continue;
    }
    p.publication.on_predicted_contact(contact, t);
    p.decisions.note_found(contact);
    for (const ObjectId object : {contact.collider, contact.collidee}) {
      if (p.scene.contains(object) && p.owners.of(object) == kNobody) p.scene.differing().try_emplace(object, t);
    }
    const bool mine = p.own.contains(contact.collider) || p.own.contains(contact.collidee);
    const bool remote = is_remote(contact.collider) || is_remote(contact.collidee);
    if (mine && !remote) continue;
    if (!mine) p.replica.colliding().on_contact(contact);
    p.replica.name_polygons(contact, false);
    p.outbox.push(ContactSeen{remote ? ContactKind::kPredicted : ContactKind::kScene, std::move(contact), t});
  }
}

}  // namespace

void report_contacts(PeerParts& p, SimTime t) {
  assert(p.replica.begun());
  report_truth(p, t);
  report_ghosts(p, t);
  // A decision made just now may have changed what followed from a contact of the past.
  p.replica.catch_up_truth();
  p.replica.catch_up_ghosts();
  const auto touch = [&](ObjectId a, ObjectId b) {
    const bool mine = p.own.contains(a) || p.own.contains(b);
    return (mine ? p.replica.truth() : p.replica.ghosts()).ends_touch(a, b, t);
  };
  const auto lies = [&](ObjectId id) {
    return (p.own.contains(id) ? p.replica.truth() : p.replica.ghosts()).is_at_rest_from(id, t);
  };
  p.replica.note_changes();
  p.replica.colliding().update(touch, lies, t);
  while (const auto change = p.replica.colliding().poll()) p.outbox.push(*change);
}

}  // namespace peerd::replication
