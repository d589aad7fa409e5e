#include "replication/peer/contact_report.hpp"

#include <algorithm>
#include <array>
#include <cassert>
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

// The world's events since the last tick, without contacts that a later one of them retracts: a decision that came in
// between has put an object on another way.
std::vector<MotionWorld::Event> poll_standing_events(MotionWorld& world) {
  std::vector<MotionWorld::Event> events;
  while (auto event = world.poll_event()) {
    if (const auto* retracted = std::get_if<ContactsRetracted>(&*event)) {
      std::erase_if(events, [&](const MotionWorld::Event& earlier) {
        const auto* c = std::get_if<ContactEvent>(&earlier);
        return c != nullptr && retracted->retracts(c->at, c->collider, c->collidee);
      });
    }
    events.push_back(*std::move(event));
  }
  return events;
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
  for (const MotionWorld::Event& event : poll_standing_events(p.replica.truth())) {
    if (const auto* overlap = std::get_if<BodiesOverlap>(&event)) {
      if (p.own.contains(overlap->collider) || p.own.contains(overlap->collidee)) p.outbox.push(*overlap);
      continue;
    }
    if (const auto* retracted = std::get_if<ContactsRetracted>(&event)) note_retraction(p, retracted->object, t);
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
  while (auto event = p.replica.ghosts().poll_event()) {
    if (const auto* retracted = std::get_if<ContactsRetracted>(&*event)) {
      const bool of_nobody = p.owners.of(retracted->object) == kNobody;
      if (is_remote(retracted->object) || of_nobody) {
        ContactsRetracted known = *retracted;
        known.of_ghosts_alone = of_nobody;
        p.outbox.push(known);
      }
      continue;
    }
    if (std::holds_alternative<BodiesOverlap>(*event)) continue;  // their owners name it
    auto& contact = std::get<ContactEvent>(*event);
    if (is_gone(*p.model, contact)) {
      const bool was_remote = is_remote(contact.collider) || is_remote(contact.collidee);
      if (was_remote) p.outbox.push(ContactSeen{ContactKind::kPredicted, std::move(contact), t});
      continue;
    }
    p.publication.on_predicted_contact(contact);
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
