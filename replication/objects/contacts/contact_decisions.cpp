#include "replication/objects/contacts/contact_decisions.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <iterator>
#include <map>
#include <ranges>
#include <tuple>
#include <utility>

#include "replication/physics/laws/response.hpp"
#include "replication/physics/parts/part_at.hpp"
#include "replication/wire/wire_limits.hpp"

namespace peerd::replication {
namespace {

// The most copies of a decision, one a tick, as the loss asks: they survive its bursts without waiting for a hello.
constexpr std::uint32_t kDecisionCopies = 3;
// A contact of longer ago, as it turns out now (a decision that came late has put an object on another way), is
// decided by no peer any more: some peers would receive the decision too late to take it, and others would not.
constexpr Duration kDecidedWithin = std::chrono::seconds(3);
// Decisions are repeated until they are so old: receivers drop those of more than 6 s (intake.cpp), and a latency has
// to fit between.
constexpr Duration kRepeatedFor = std::chrono::seconds(5);
// An owner that has not taken up a decision for so long has never received it: its updates count again.
constexpr Duration kDecisionStands = std::chrono::seconds(2);
// Decisions are noted in hellos, where there is little room, until they are so old.
constexpr Duration kAnnouncedFor = std::chrono::milliseconds(3500);
// Longer than any decision that a receiver would take can be on its way.
constexpr Duration kRememberedFor = std::chrono::seconds(8);
// An object that hangs between two others touches them many times a second. Of one pair only the newest decisions are
// repeated where nothing says whether they have come, as many as there can be in 250 ms (4 ms apart:
// contact_report.cpp, kSameTouch).
constexpr int kRepeatedOfPair = 64;
// The most decisions of one peer on one pair that are remembered: twice as many as there can be in kRememberedFor.
constexpr std::size_t kOfPairMax = 4000;

// Whether nothing drives the object any more once it has met something.
bool stops_for_good(const WorldModel& model, ObjectId object) {
  const CollisionResponse* const response = model.response_of(object);
  return response != nullptr && response->type == ResponseType::kZero;
}

// Another interest in the pair may name the two the other way round.
bool has_outcome(const DecisionRecord& d, const ContactEvent& c) {
  const bool same_way = d.collider == c.collider;
  return d.collider_after == (same_way ? c.collider_after : c.collidee_after) &&
         d.collidee_after == (same_way ? c.collidee_after : c.collider_after);
}

// Returns the same contact at the next time that a decision can have, 1 ns later, with the states of then. An object
// that slides goes on sliding (law_of_outcome).
ContactEvent a_nanosecond_later(const WorldModel& model, ContactEvent c) {
  c.at += Duration{1};
  for (const auto& [object, before, after] : {std::tuple{c.collider, &c.collider_before, &c.collider_after},
                                              std::tuple{c.collidee, &c.collidee_before, &c.collidee_after}}) {
    const CollisionResponse* const response = model.response_of(object);
    for (KinematicState* const s : {before, after}) {
      const MotionModel law = law_of_outcome(response, *s);
      *s = advance(*s, to_seconds(Duration{1}));
      if (law.kind == MotionKind::kSliding) *s = law_after(response, law, *s).state;
    }
  }
  return c;
}

// Whether a decision that is made now on a contact of that time reaches all peers in time.
bool reaches_all_in_time(const TickGrid& ticks, SimTime contact) {
  return contact >= ticks.last_time() - kDecidedWithin;
}

// Whether every peer of the session has the decision, as far as they say.
bool is_acknowledged_by_all(const Membership& members, const DecisionLog::Entry& own) {
  return std::ranges::all_of(members.all(), [&](const auto& member) {
    // In a large session some are heard that do not hear this peer.
    if (members.is_large() && !member.second.echo.echoes_us) return true;
    return !member.second.synchronised || own.acknowledged_by.contains(member.first);
  });
}

}  // namespace

ContactDecisions::ContactDecisions(const PeerConfig& config, const ModelInForce& model, Membership& members,
                                   const Owners& owners, const SceneObjects& scene, OwnObjects& own, Replica& replica,
                                   Display& display, const TickGrid& ticks, Outbox& outbox, PeerCounters& counters,
                                   OnDecided on_decided)
    : config_(config),
      model_(model),
      members_(members),
      owners_(owners),
      scene_(scene),
      own_(own),
      replica_(replica),
      watch_(config, model, owners, scene, own, replica),
      drives_(owners, replica),
      display_(display),
      ticks_(ticks),
      outbox_(outbox),
      counters_(counters),
      on_decided_(std::move(on_decided)) {
  assert(on_decided_);
}

// ---- the contacts that this peer looks for ----

bool ContactDecisions::may_decide(PeerId peer, PeerId owner_a, PeerId owner_b) const {
  if (owner_a == kNobody || owner_b == kNobody || owner_a == owner_b) return false;
  if (config_.decisions.policy == DecisionPolicy::kId) return peer == decider_by_id(owner_a, owner_b);
  const bool is_server = config_.decisions.policy == DecisionPolicy::kServer && peer == config_.decisions.server;
  return peer == owner_a || peer == owner_b || is_server;
}

// The receiver may know another owner of a scene object than the decider did, or none. The log says which of several
// decisions count.
bool ContactDecisions::may_have_decided(PeerId peer, const DecisionRecord& d) const {
  return scene_.contains(d.collider) || scene_.contains(d.collidee) ||
         may_decide(peer, owners_.of(d.collider), owners_.of(d.collidee));
}

// Whether this peer looks for contacts of the two. By the policy `id` a peer that doesn't decide has no need to; else
// both owners look: which of them is to decide depends on when, and it may fall back to the other.
// The states of both owners from so long before a contact have reached all peers.
Duration ContactDecisions::lookback() const {
  return config_.decisions.lookback ? *config_.decisions.lookback : members_.longest_latency();
}

std::optional<Pose> ContactDecisions::camera_pose(const Viewpoint& viewpoint, SimTime at) const {
  if (!viewpoint.object) return viewpoint.pose;
  if (!replica_.ghosts().has_history_at(*viewpoint.object, at)) return std::nullopt;
  const Pose carrier = replica_.ghosts().at(*viewpoint.object, at).pose();
  return Pose{carrier * viewpoint.pose.position, (carrier.orientation * viewpoint.pose.orientation).normalized()};
}

Contender ContactDecisions::contender(ObjectId object, SimTime at, std::span<const WorldBox> meeting) const {
  Contender s{owners_.of(object), std::nullopt, members_.own_latency(), false};
  const MotionWorld& ghosts = replica_.ghosts();
  if (ghosts.has_history_at(object, at)) s.state = ghosts.at(object, at);
  std::optional<Viewpoint> viewpoint = config_.decisions.viewpoint;
  if (s.owner != config_.id) {
    const auto member = members_.all().find(s.owner);
    if (member == members_.all().end()) return s;
    s.latency = member->second.latency;
    viewpoint = member->second.viewpoint;
  }
  if (config_.decisions.policy != DecisionPolicy::kFieldOfView || !viewpoint) return s;
  const std::optional<Pose> from = camera_pose(*viewpoint, at);
  if (!from) return s;
  // The camera must see both of them: a viewpoint that rides on one has that one in view wherever it looks.
  const collision::Camera camera{*from, viewpoint->field_of_view, viewpoint->aspect};
  s.sees = std::ranges::all_of(meeting, [&](const WorldBox& box) { return sees(camera, box); });
  return s;
}

PeerId ContactDecisions::choose_decider(ObjectId a, ObjectId b, SimTime contact) const {
  const SimTime at = decided_as_of(contact, lookback());
  for (const ObjectId object : {a, b}) replica_.compute_ghost(object);
  // The boxes of the two where they are then: around all parts, those that carriers below them move or that flex
  // included.
  std::vector<WorldBox> meeting;
  for (const ObjectId object : {a, b}) {
    WorldBox& box = meeting.emplace_back();
    for (const std::uint32_t part : model_->parts_of_node[model_->index_of(object)]) {
      box.merge(part_at(*model_, replica_.ghosts(), replica_.flexible(), part, at).box());
    }
  }
  const PeerId server = config_.decisions.server;
  const bool here = server == config_.id || members_.contains(server);
  return decider(config_.decisions.policy, contender(a, at, meeting), contender(b, at, meeting),
                 here ? server : kNobody);
}

// A contact of two other peers' objects is nothing but a prediction.
ContactAuthority ContactDecisions::authority(ObjectId a, ObjectId b, SimTime contact) const {
  const bool mine = own_.contains(a) || own_.contains(b);
  if (mine && (is_free_scene_object(a) || is_free_scene_object(b))) {
    return reaches_all_in_time(ticks_, contact) ? ContactAuthority::kAsPublished : ContactAuthority::kDeferred;
  }
  if (!owners_.have_two(a, b)) return ContactAuthority::kAsPublished;
  if (!watch_.searches(a, b)) {
    return watch_.rests(a, b) ? ContactAuthority::kDeferred : ContactAuthority::kAsPublished;
  }
  if (!reaches_all_in_time(ticks_, contact)) return ContactAuthority::kDeferred;
  if (config_.decisions.policy == DecisionPolicy::kId) return ContactAuthority::kLocal;
  return choose_decider(a, b, contact) == config_.id ? ContactAuthority::kLocal : ContactAuthority::kDeferred;
}

// ---- contacts that this peer has found ----

// An object that spins up, or is hit by one that goes as fast as can be, leaves the limits within which receivers take
// states. They would refuse the decision, and the whole datagram with it.
ContactEvent ContactDecisions::within_wire_limits(ContactEvent c) {
  for (KinematicState* const s : {&c.collider_before, &c.collidee_before, &c.collider_after, &c.collidee_after}) {
    if (acceptable(*s)) continue;
    *s = at_rest_within_limits(*s);
    ++counters_.states_out_of_range;
  }
  return c;
}

DecisionRecord ContactDecisions::record_of(const ContactEvent& c, DecisionRule rule) const {
  DecisionRecord d{c.collider,
                   c.collidee,
                   c.at,
                   c.normal,
                   c.collider_before,
                   c.collidee_before,
                   c.collider_after,
                   c.collidee_after,
                   rule,
                   log_.last(c.collider, c.collidee)};
  d.rests = c.rests && acceptable(c.collider_free) && acceptable(c.collidee_free) &&
            !stops_for_good(*model_, c.collider) && !stops_for_good(*model_, c.collidee);
  if (!d.rests) return d;
  if (c.collider_free != d.collider_before.acceleration) d.collider_free = c.collider_free;
  if (c.collidee_free != d.collidee_before.acceleration) d.collidee_free = c.collidee_free;
  return d;
}

// ---- what drives objects that rest (resting_drives.hpp) ----

void ContactDecisions::on_drive(const UpdateRecord& u) {
  const std::optional<Drive> drive = drives_.in(u);
  if (!drive || model_->pairs_of(u.object).empty()) return;
  const bool owned = own_.contains(u.object);
  const auto lay_again = [&](ObjectId object, SimTime from) {
    owned ? replay_ghost(object, from) : rebase(object, from);
    const OwnObject* own = own_.find(object);
    if (!owned && own != nullptr && own->last_sent) own_.republish(object);
  };
  bool changed = false;
  for (const DecisionLog::Entry& e : log_.entries()) {
    const DecisionRecord& d = e.record;
    if (!e.in_force || !d.rests || d.contact < drive->since) continue;
    if (d.collider != u.object && d.collidee != u.object) continue;
    if (drives_.after(d, e.author, u.object) == drives_.after(d, e.author, u.object, u.sequence)) continue;
    for (const ObjectId object : {d.collider, d.collidee}) {
      if (binds(d, e.author, object)) lay_again(object, d.contact);
    }
    changed = true;
  }
  // An update between that one and the change is lost.
  if (!changed && u.drive && drive->since < u.at) {
    const std::optional<Vec3> known = drives_.published(u.object, u.at, u.sequence);
    changed = known && *known != drive->acceleration;
    if (changed) lay_again(u.object, drive->since);
  }
  if (changed && !owned) replica_.catch_up_truth();
}

std::vector<DecisionLog::Change> ContactDecisions::add_own(const DecisionRecord& d, CollisionType type) {
  ++counters_.decisions;
  auto changes = log_.add(d, config_.id);
  for (DecisionLog::Entry& e : log_.entries()) {
    const bool added =
        e.author == config_.id && e.record.contact == d.contact && of_pair(e.record, d.collider, d.collidee);
    if (added && !e.type) e.type = type;
    if (!added || !e.in_force) continue;
    e.copies = static_cast<int>(copies_against(members_.worst_loss_to_peers(), kDecisionCopies));
  }
  return changes.value_or(std::vector<DecisionLog::Change>{});
}

// A contact that was decided here before and is found again is another decision where it was overruled (the objects go
// the way that the other peer's decision gave) and where it has another outcome now (an update came late, and they meet
// by another face): it is a nanosecond later, for decisions are distinguished by their times. So is the second one on
// an object at one instant, as where something that rests on another is struck: all peers lay them in their order.
void ContactDecisions::decide(const ContactEvent& contact, SimTime known_at) {
  assert(!contact.deferred);
  ContactEvent c = within_wire_limits(contact);
  // Two peers that find one contact at one instant decide it once: the one that comes second takes the other's.
  if (log_.is_decided_by_another(c.at, config_.id, c.collider, c.collidee, config_.decisions.policy)) {
    for (const ObjectId object : {c.collider, c.collidee}) rebase(object, c.at);
    return;
  }
  for (;; c = within_wire_limits(a_nanosecond_later(*model_, c))) {
    const auto* known = log_.find(c.at, config_.id, c.collider, c.collidee);
    if (known != nullptr && known->in_force && has_outcome(known->record, c)) break;  // the same once more
    if (known == nullptr && !log_.has_another(c.at, config_.id, c.collider, c.collidee)) break;
  }
  const DecisionRecord record = record_of(c, config_.decisions.policy);
  const auto changes = add_own(record, c.type);
  display_.on_decision(c.at, known_at);
  (void)name_owners(changes);
  // All peers that receive the decision will do so: the own object's ghost moves, too, or this peer's copy of their
  // ghosts would differ.
  for (const ObjectId object : {c.collider, c.collidee}) {
    if (model_->is_answered(c.collider, c.collidee) && binds(record, config_.id, object)) replay_ghost(object, c.at);
  }
  replica_.colliding().on_contact(c);
  replica_.name_polygons(c, true);
  outbox_.push(ContactSeen{ContactKind::kDecided, c, known_at, config_.id});
  const bool alone = changes.size() == 1 && changes.front().author == config_.id;
  if (!alone) apply(changes, known_at);
}

std::optional<ObjectId> ContactDecisions::scene_object_moved(const ContactEvent& c) const {
  for (const ObjectId object : {c.collider, c.collidee}) {
    if (is_free_scene_object(object) && changes_motion_of(object, c)) return object;
  }
  return std::nullopt;
}

// A contact just before one that has been decided is the same collision, found here by somewhat other states than the
// decider's: its decision has come before this peer's own tick.
void ContactDecisions::defer(const ContactEvent& c) {
  assert(c.deferred);
  if (!owners_.have_two(c.collider, c.collidee)) {  // a scene object goes on
    ++counters_.contacts_too_late;
    return;
  }
  if (watch_.rests(c.collider, c.collidee)) return;  // the other owner finds it, and decides
  const SimTime decided = log_.last(c.collider, c.collidee);
  if (decided >= c.at && decided <= c.at + DecisionLog::kSameCollision) return;
  if (!reaches_all_in_time(ticks_, c.at)) {
    ++counters_.contacts_too_late;
    return;
  }
  ++counters_.contacts_held;
  note_found(c);
  deferred_.push_back({c, choose_decider(c.collider, c.collidee, c.at)});
}

bool ContactDecisions::awaits_decision_on(ObjectId object) const {
  return std::ranges::any_of(
      deferred_, [&](const Deferred& h) { return h.contact.collider == object || h.contact.collidee == object; });
}

// Contacts on which the peer that is to decide has said nothing in time. The lower id decides them; the other one where
// it was the lower one that said nothing, and else once a decision of the lower one would have come: the lower one may
// not have found the contact.
void ContactDecisions::resolve_overdue(SimTime t) {
  log_.forget_before(t - kRememberedFor);
  const Duration patience = 2 * lookback() + 3 * config_.hello_period;
  const Duration lower_id_delay = lookback() + config_.hello_period;
  std::vector<Deferred> over;
  for (const Deferred& h : deferred_) {
    const PeerId lower = decider_by_id(owners_.of(h.contact.collider), owners_.of(h.contact.collidee));
    const Duration wait = members_.contains(h.decider) ? patience : Duration{0};
    const bool first = lower == config_.id || lower == h.decider;
    if (t >= h.contact.at + wait + (first ? Duration{0} : lower_id_delay)) over.push_back(h);
  }
  for (const Deferred& h : over) decide_by_fallback(h.contact, t);
}

void ContactDecisions::decide_by_fallback(const ContactEvent& c, SimTime known_at) {
  std::erase_if(deferred_, [&](const Deferred& h) {
    return h.contact.at == c.at && h.contact.collider == c.collider && h.contact.collidee == c.collidee;
  });
  if (!config_.decisions.fallback || !owners_.have_two(c.collider, c.collidee)) return;
  if (!reaches_all_in_time(ticks_, c.at)) {
    ++counters_.contacts_too_late;
    return;
  }
  ++counters_.decisions_fallback;
  display_.on_decision(c.at, known_at);
  apply(add_own(record_of(within_wire_limits(c), DecisionRule::kId), c.type), known_at);
}

// Whether that peer may have found nothing because it does not know how an own object came to the contact: it has not
// confirmed the last update from before it, or one that was replaced unconfirmed.
bool ContactDecisions::may_have_missed_our_update(PeerId peer, const ContactEvent& c) const {
  if (config_.regions.cell_m > 0.0) return false;  // updates to regions are not acknowledged
  return std::ranges::any_of(std::array{c.collider, c.collidee}, [&](ObjectId object) {
    const OwnObject* own = own_.find(object);
    if (own == nullptr || !own->last_sent || own->delivery.acknowledged_by.contains(peer)) return false;
    return own->delivery.unacknowledged_by.contains(peer) || *own->last_sent <= c.at;
  });
}

// ---- what other peers say ----

void ContactDecisions::on_contact_notes(PeerId sender, const Hello& hello, SimTime known_at) {
  assert(members_.contains(sender));
  const SimTime sent_at = known_at - members_.find(sender)->delays.last();
  const std::vector<Deferred> waiting = deferred_;
  for (const Deferred& h : waiting) {
    if (h.decider != sender) continue;
    const auto same = [&](const ContactNote& n) {
      const bool pair = (n.collider == h.contact.collider && n.collidee == h.contact.collidee) ||
                        (n.collider == h.contact.collidee && n.collidee == h.contact.collider);
      return pair && n.contact >= h.contact.at - DecisionLog::kSameCollision &&
             n.contact <= h.contact.at + DecisionLog::kSameCollision;
    };
    const auto note = std::ranges::find_if(hello.notes, same);
    if (note != hello.notes.end() && note->deferred) {  // each left it to the other
      if (decider_by_id(config_.id, sender) == config_.id) decide_by_fallback(h.contact, known_at);
    } else if (note == hello.notes.end() && sent_at >= h.contact.at + lookback() && hello.notes.size() < kNotesMax &&
               !may_have_missed_our_update(sender, h.contact)) {
      ++counters_.contacts_refuted;
      std::erase_if(deferred_,
                    [&](const Deferred& other) { return other.contact.at == h.contact.at && other.decider == sender; });
    }
  }
}

// A peer that has just joined may not know yet who owns the objects: it acknowledges the decision as missing, so that
// it is repeated.
const char* ContactDecisions::on_decision(PeerId sender, std::uint32_t number, const DecisionRecord& d,
                                          SimTime known_at) {
  assert(d.contact <= known_at);
  if (!model_->are_paired(d.collider, d.collidee)) {
    const Scene& scene = *model_->scene;
    const bool may_come = !scene.contains(d.collider) || !scene.contains(d.collidee);  // by an operation
    if (may_come) members_.find(sender)->mark_as_missing(number);
    return "no_pair";
  }
  if (!may_have_decided(sender, d)) {
    members_.find(sender)->mark_as_missing(number);
    return "not_decider";
  }
  if (const char* why = why_void(d)) return why;
  if (log_.count(sender, d.collider, d.collidee) >= kOfPairMax) return "too_many_decisions";
  const auto changes = log_.add(d, sender);
  if (!changes) return "decision_known";
  if (changes->empty()) {
    // An update may have come before it, by which its author owned the object.
    const auto last = DecisionLog::Change{d, sender, false};
    for (const ObjectId object : name_owners({&last, 1})) rebase(object, log_.last(object));
    return "decision_overruled";
  }
  display_.on_decision(d.contact, known_at);
  apply(*changes, known_at);
  return nullptr;
}

// A decision on an object that has had another owner since, or the same one in another life, is of an object that is no
// more. The own objects' present life began with the worlds here.
const char* ContactDecisions::why_void(const DecisionRecord& d) const {
  for (const ObjectId object : {d.collider, d.collidee}) {
    if (own_.contains(object) && replica_.begun() && d.contact < replica_.begun_at()) return "decision_before_life";
    const auto life = life_since_.find(object);
    if (life == life_since_.end()) continue;
    const SimTime begins = replica_.begun() ? std::max(life->second, replica_.begun_at()) : life->second;
    if (d.contact < begins) return "decision_before_life";
  }
  return nullptr;
}

// The decision itself gives a scene object to its author. A decision that has been overruled names no owner.
// Returns the objects that have another owner now.
std::vector<ObjectId> ContactDecisions::name_owners(std::span<const DecisionLog::Change> changes) const {
  std::vector<ObjectId> given;
  for (const DecisionLog::Change& change : changes) {
    for (const ObjectId object : {change.record.collider, change.record.collidee}) {
      if (!scene_.contains(object)) continue;
      const DecisionLog::Entry* const last = log_.last_entry(object);
      if (last == nullptr) continue;
      const SceneObject& known = scene_.at(object);
      const SimTime contact = last->record.contact;
      if (contact < known.decided && !log_.overruled(object, known.decided)) continue;
      if (contact == known.decided && (known.is_free || last->author <= known.decided_by)) continue;
      on_decided_(object, last->author, contact);
      given.push_back(object);
    }
  }
  return given;
}

void ContactDecisions::apply(const std::vector<DecisionLog::Change>& changes, SimTime known_at) {
  (void)name_owners(changes);
  for (const DecisionLog::Change& change : changes) {
    const DecisionRecord& d = change.record;
    // By the policy `id` one owner does not look for contacts of the two. It has to solve a resting one all the same.
    if (watch_.leaves(d.collider, d.collidee)) {
      const auto known = std::views::reverse(log_.entries());
      const auto last = std::ranges::find_if(
          known, [&](const DecisionLog::Entry& e) { return e.in_force && of_pair(e.record, d.collider, d.collidee); });
      const bool here = replica_.receives(d.collider) && replica_.receives(d.collidee);
      watch_.set_rests(d.collider, d.collidee, here && last != known.end() && last->record.rests);
    }
    if (change.in_force) {
      apply(d, change.author, known_at);
      continue;
    }
    ++counters_.decisions_overruled;
    outbox_.push(Overruled{d.collider, d.collidee, d.contact});
    for (const ObjectId object : {d.collider, d.collidee}) {
      own_.republish(object);
      if (binds(d, change.author, object)) replay_ghost(object, d.contact);
    }
  }
  replica_.catch_up_truth();  // walls that an own object met after the contact
}

// An object that answers no contact follows the decisions of its owner alone: the other peers know its motion only as
// it was a latency ago.
bool ContactDecisions::binds(const DecisionRecord& d, PeerId author, ObjectId object) const {
  if (object != d.collider && object != d.collidee) return false;
  if (changes_motion_of(object, d)) return true;
  if (model_->response_of(object) == nullptr && owners_.of(object) != author) return false;
  return !scene_.contains(object == d.collider ? d.collidee : d.collider);
}

SimTime ContactDecisions::last_binding(ObjectId object, SimTime until) const {
  for (auto e = log_.entries().rbegin(); e != log_.entries().rend(); ++e) {
    if (e->in_force && e->record.contact <= until && binds(e->record, e->author, object)) return e->record.contact;
  }
  return SimTime{};
}

bool ContactDecisions::counts(const UpdateRecord& u, SimTime decided) const {
  if (u.decision < decided && u.at < decided + kDecisionStands) return false;
  return !log_.overruled(u.object, u.decision) || u.at >= u.decision + kDecisionStands;
}

// The decision holds from the contact time on, not from its arrival.
void ContactDecisions::apply(const DecisionRecord& d, PeerId author, SimTime known_at) {
  std::erase_if(deferred_, [&](const Deferred& h) { return of_pair(d, h.contact.collider, h.contact.collidee); });
  for (const ObjectId object : {d.collider, d.collidee}) {
    if (!binds(d, author, object)) continue;
    rebase(object, d.contact);
    const OwnObject* own = own_.find(object);
    if (own != nullptr && own->last_sent && *own->last_sent > d.contact) own_.republish(object);
  }
  if (!replica_.receives(d.collider) || !replica_.receives(d.collidee)) return;  // nothing to report of those
  ContactEvent contact{d.contact,         d.collider,        d.collidee,       d.normal,
                       d.collider_before, d.collidee_before, d.collider_after, d.collidee_after};
  contact.type = type_of(d, author);
  replica_.name_polygons(contact, own_.contains(d.collider) || own_.contains(d.collidee));
  replica_.colliding().on_contact(contact);
  const ContactKind kind = author == config_.id ? ContactKind::kDecided : ContactKind::kApplied;
  outbox_.push(ContactSeen{kind, std::move(contact), known_at, author});
}

void ContactDecisions::note_found(const ContactEvent& c) {
  if (model_->pairs_between(c.collider, c.collidee).size() < 2) return;
  const auto [lower, higher] = std::minmax(c.collider, c.collidee);
  last_found_.insert_or_assign({lower, higher, c.type}, c.at);
}

// A decision of another peer does not carry the type. The interest whose contact was found here nearest in time gives
// it, or else the file's first interest in the two.
CollisionType ContactDecisions::type_of(const DecisionRecord& d, PeerId author) const {
  const DecisionLog::Entry* const entry = log_.find(d.contact, author, d.collider, d.collidee);
  if (entry != nullptr && entry->type) return *entry->type;
  const auto [lower, higher] = std::minmax(d.collider, d.collidee);
  std::optional<std::pair<Duration, CollisionType>> nearest;
  for (const CollisionType type : {CollisionType::kBox, CollisionType::kWitness, CollisionType::kAllPairs}) {
    const auto found = last_found_.find({lower, higher, type});
    if (found == last_found_.end()) continue;
    const Duration apart = std::max(found->second - d.contact, d.contact - found->second);
    if (!nearest || apart < nearest->first) nearest = {apart, type};
  }
  if (nearest) return nearest->second;
  const std::vector<std::uint32_t> between = model_->pairs_between(d.collider, d.collidee);
  return between.empty() ? CollisionType::kWitness : model_->pairs[between.front()].type;
}

// The law after a decision, in the frame of the object's carrier in that world.
MotionModel ContactDecisions::outcome_in(const MotionWorld& world, ObjectId object, SimTime t,
                                         const KinematicState& after) const {
  return law_of_outcome(model_->response_of(object), world.in_carrier(object, t, after));
}

// Gives both worlds the object's way from there on, by all that is known.
void ContactDecisions::rebase(ObjectId object, SimTime from) {
  const OwnObject* own = own_.find(object);
  // The object may not have met what it has met by itself since then.
  if (own != nullptr && !own->driven) outbox_.push(ContactsRetracted{object, from});
  replay(object, from, true);
}

// Lays the outcome of a decision for an own object. The owner may have changed the object's velocity (a launch, a key)
// without the decider knowing it yet: the decided velocity before the contact is then nearer to the one without that
// change. After a change before the contact the object takes the difference that the decision makes, and keeps its own
// velocity. A change after the contact is made again after the decision.
void ContactDecisions::lay_own_outcome(const DecisionLog::Entry& e, ObjectId object, const KinematicState& after,
                                       const std::optional<Rest>& rest) {
  const DecisionRecord& d = e.record;
  MotionWorld& truth = replica_.truth();
  MotionModel outcome = outcome_in(truth, object, d.contact, after);
  const CollisionResponse* const response = model_->response_of(object);
  const KinematicState before =
      truth.in_carrier(object, d.contact, d.collider == object ? d.collider_before : d.collidee_before);
  const std::vector<VelocityChange>& changes = own_.at(object).velocity_changes;
  const auto is_unknown = [&](const VelocityChange& change, const Vec3& velocity) {
    const Vec3 without = velocity - (change.after - change.before);
    return (before.velocity - without).norm() < (before.velocity - velocity).norm();
  };
  const bool of_another = e.author != config_.id;
  const auto last = std::ranges::find_if(std::views::reverse(changes),
                                         [&](const VelocityChange& change) { return change.at < d.contact; });
  if (of_another && last != changes.rend() && last->at >= log_.last_before(object, d.contact)) {
    KinematicState own = advance(truth.relative_at(object, d.contact - Duration{1}), 1e-9);
    if (is_unknown(*last, own.velocity)) {
      const MotionModel decided = outcome;
      own.velocity += decided.state.velocity - before.velocity;
      own.acceleration = decided.state.acceleration;
      own.angular_velocity_body = decided.state.angular_velocity_body;
      outcome = law_of_outcome(response, own);
      own_.republish(object);
    }
  }
  truth.set_base(object, d.contact, outcome, rest);
  for (const VelocityChange& change : changes) {
    if (!of_another || change.at < d.contact || !is_unknown(change, change.after)) continue;
    const SimTime t = std::max(change.at, d.contact + Duration{1});
    const MotionModel law = truth.model_at(object, t);
    KinematicState state = law.state;
    state.velocity = change.replaces ? change.after : Vec3(state.velocity + change.after - change.before);
    truth.set_base(object, t, law_after(response, law, state));
    own_.republish(object);
  }
}

// Without a decision on an earlier contact that came later there would be a gap in which the two meet once more. The
// truth of an own object that physics moves takes the decisions, and no update. `in_truth`: the truth changes as well.
void ContactDecisions::replay(ObjectId object, SimTime from, bool in_truth) {
  const OwnObject* own = own_.find(object);
  const bool owned = own != nullptr, moved_by_physics = owned && !own->driven;
  const auto lay = [&](SimTime t, const std::optional<MotionModel>& model, const std::optional<Rest>& rest = {},
                       const std::optional<Vec3>& free = {}) {
    replica_.set_ghost(object, t, model, owned || !in_truth, rest, free);
  };
  replica_.note_change_ahead(object);
  replica_.ghosts().forget_bases(object, from);
  std::vector<UpdateRecord> updates;
  std::ranges::copy_if(replica_.kept_updates(object), std::back_inserter(updates),
                       [&](const UpdateRecord& update) { return update.at >= from; });
  auto next = updates.begin();
  SimTime decided = last_binding(object, from - Duration{1}), laid = from - Duration{1};
  const auto lay_updates_until = [&](SimTime end) {
    for (; next != updates.end() && next->at < end; ++next) {
      if (!counts(*next, decided)) continue;
      const Base base = replica_.base_of(*next);
      if (base.free && next->drive->since > laid && next->drive->since < next->at) {
        lay(next->drive->since, std::nullopt, {}, base.free);
      }
      lay(base.at, base.model, {}, base.free);
      laid = next->at;
    }
  };
  SimTime last = from;
  for (const DecisionLog::Entry& e : log_.entries()) {
    const DecisionRecord& d = e.record;
    if (!e.in_force || d.contact < from || !binds(d, e.author, object)) continue;
    lay_updates_until(d.contact);
    decided = d.contact;
    if (!model_->is_answered(d.collider, d.collidee)) continue;
    const KinematicState& after = d.collider == object ? d.collider_after : d.collidee_after;
    const std::optional<Rest> rest = drives_.rest_of(e, object);
    if (in_truth && moved_by_physics) lay_own_outcome(e, object, after, rest);
    lay(d.contact, outcome_in(replica_.ghosts(), object, d.contact, after), rest);
    last = laid = d.contact;
  }
  if (is_free_scene_object(object) && scene_.at(object).freed >= last) {
    const SceneObject& freed = scene_.at(object);
    const UpdateRecord state{object, freed.sequence, freed.freed, freed.model, freed.decided, {}, freed.carrier};
    lay(freed.freed, replica_.base_of(state).model);
    return;
  }
  lay_updates_until(SimTime::max());
}

void ContactDecisions::on_acknowledgement(PeerId sender, const Acknowledgement& acknowledgement) {
  for (DecisionLog::Entry& e : log_.entries()) {
    if (e.author != config_.id || e.sent_in.empty() || e.acknowledged_by.contains(sender)) continue;
    if (std::ranges::any_of(e.sent_in, [&](std::uint32_t number) { return acknowledgement.has(number); })) {
      e.acknowledged_by.insert(sender);
    } else if (acknowledgement.surely_lost(e.sent_in.back())) {
      repeat(e);
    }
  }
}

bool ContactDecisions::is_of_scene(const DecisionRecord& d) const {
  return scene_.contains(d.collider) || scene_.contains(d.collidee);
}

void ContactDecisions::forget_numbers() {
  for (DecisionLog::Entry& decision : log_.entries()) decision.sent_in.clear();
}

void ContactDecisions::on_new_session_of(PeerId sender) {
  for (DecisionLog::Entry& decision : log_.entries()) {
    decision.sent_in.clear();
    decision.acknowledged_by.erase(sender);
  }
}

// ---- what goes out ----

void ContactDecisions::repeat_unacknowledged() {
  if (!replica_.begun()) return;
  const Duration patience = members_.acknowledged_within(config_.settled_hello_period);
  const SimTime answered = ticks_.last_time() - std::min<Duration>(patience, kRepeatedFor / 2);
  std::map<std::pair<ObjectId, ObjectId>, int> newer;
  for (auto entry = log_.entries().rbegin(); entry != log_.entries().rend(); ++entry) {
    if (entry->author != config_.id || !entry->in_force || entry->record.contact > answered) continue;
    if (newer[std::minmax(entry->record.collider, entry->record.collidee)]++ >= kRepeatedOfPair) continue;
    if (!is_acknowledged_by_all(members_, *entry)) repeat(*entry);
  }
}

void ContactDecisions::repeat(DecisionLog::Entry& own) {
  if (!config_.decisions.repeat || !own.in_force || own.copies > 0) return;
  if (own.record.contact < ticks_.last_time() - kRepeatedFor) return;
  own.copies = 1;
  ++counters_.decisions_repeated;
}

std::vector<ContactNote> ContactDecisions::notes() const {
  std::vector<ContactNote> notes;
  for (const Deferred& h : deferred_) {
    if (notes.size() == kNotesMax) return notes;
    notes.push_back({h.contact.collider, h.contact.collidee, h.contact.at, true});
  }
  const SimTime since = replica_.begun() ? ticks_.last_time() - kAnnouncedFor : SimTime{};
  for (auto entry = log_.entries().rbegin(); entry != log_.entries().rend(); ++entry) {
    const DecisionRecord& d = entry->record;
    if (entry->author != config_.id || d.contact < since || is_acknowledged_by_all(members_, *entry)) continue;
    if (notes.size() == kNotesMax) break;
    notes.push_back({d.collider, d.collidee, d.contact, false});
  }
  return notes;
}

void ContactDecisions::note_sent(std::span<const DecisionRecord> decisions, std::uint32_t number) {
  for (const DecisionRecord& d : decisions) {
    DecisionLog::Entry* entry = log_.find(d.contact, config_.id, d.collider, d.collidee);
    assert(entry != nullptr);
    entry->sent_in.push_back(number);
  }
}

void ContactDecisions::remove(ObjectId object) {
  std::erase_if(deferred_,
                [&](const Deferred& d) { return d.contact.collider == object || d.contact.collidee == object; });
  log_.forget(object);
  life_since_.erase(object);
  watch_.forget_rests_of(object);
}

void ContactDecisions::end_life_of(ObjectId object, SimTime t) {
  life_since_[object] = t;
  watch_.forget_rests_of(object);
}

void ContactDecisions::forget(ObjectId object, SimTime t) {
  log_.forget(object);
  end_life_of(object, t);
}

void ContactDecisions::restart(bool same_session) {
  deferred_.clear();
  if (same_session) return;
  watch_.forget_rests();
  log_.clear();
  life_since_.clear();
  last_found_.clear();
}

}  // namespace peerd::replication
