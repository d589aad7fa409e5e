// Peer: who decides collisions between objects of two peers, and what becomes of what was decided.
#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

#include "replication/peer.hpp"
#include "replication/motion/response.hpp"
#include "replication/wire/wire_limits.hpp"

namespace peerd::replication {
namespace {

// So many copies at most, one a tick, as the loss asks: they survive its bursts without waiting for a hello.
constexpr std::uint32_t kDecisionCopies = 3;
// What happened longer ago, as it turns out now (a decision heard late has put an object on another way), nobody
// decides any more: who hears of it would be too late to take it, and another not.
constexpr Duration kDecidedWithin = std::chrono::seconds(3);
// Decisions are told again until they are so old: receivers drop those of more than 6 s (peer_intake.cpp), and a
// latency has to fit between.
constexpr Duration kRepeatedFor = std::chrono::seconds(5);
// .. and noted in hellos so long, where there is little room.
constexpr Duration kAnnouncedFor = std::chrono::milliseconds(3500);
// Longer than any decision that a receiver would take can be on its way.
constexpr Duration kRememberedFor = std::chrono::seconds(8);
// What hangs between two others touches them many times a second. Of one pair only the newest are repeated where
// nothing says whether they have come, as many as there can be in 250 ms (4 ms apart: peer_tick.cpp, kOneTouch).
constexpr int kRepeatedOfPair = 64;
// Of one peer's on one pair, so many are remembered: twice as many as there can be in kRememberedFor.
constexpr std::size_t kOfPairMax = 4000;
// Where own objects that something drives were: who shows them late needs more; contacts with them are found as they
// come.
constexpr Duration kDrivenKept = std::chrono::milliseconds(500);

}  // namespace

bool Peer::has_two_owners(ObjectId a, ObjectId b) const {
  const PeerId owner_a = owner(a), owner_b = owner(b);
  return owner_a != kNobody && owner_b != kNobody && owner_a != owner_b;
}

bool Peer::is_decision_server() const {
  return config_.decisions.policy == DecisionPolicy::kServer && config_.decisions.server == config_.id;
}

bool Peer::may_decide(PeerId peer, PeerId owner_a, PeerId owner_b) const {
  if (owner_a == kNobody || owner_b == kNobody || owner_a == owner_b) return false;
  if (config_.decisions.policy == DecisionPolicy::kId) return peer == decider_by_id(owner_a, owner_b);
  const bool is_server = config_.decisions.policy == DecisionPolicy::kServer && peer == config_.decisions.server;
  return peer == owner_a || peer == owner_b || is_server;
}

// Whether this peer looks for contacts of the two. By id, who doesn't decide has no need to; else both owners look:
// which of them is to decide depends on when, and it may fall back to the other.
bool Peer::searches_contacts_of(ObjectId a, ObjectId b) const {
  const bool mine = own_objects_.contains(a) || own_objects_.contains(b);
  if (!has_two_owners(a, b)) return mine;
  if (config_.decisions.policy == DecisionPolicy::kId) return decider_by_id(owner(a), owner(b)) == config_.id;
  return mine || is_decision_server();
}

Duration Peer::own_latency() const {
  Duration longest{0};
  for (const auto& [peer, member] : members_.all()) {
    const std::size_t known = std::min(member.delays_known, member.delays.size());
    for (std::size_t i = 0; i < known; ++i) longest = std::max(longest, member.delays[i]);
  }
  return std::min<Duration>(latency_bound(longest), kLatencyMax);
}

// Of any peer of the session.
Duration Peer::longest_latency() const {
  Duration longest = own_latency();
  for (const auto& [peer, member] : members_.all()) longest = std::max(longest, member.latency);
  return longest;
}

// Both owners' states so far back have reached everybody.
Duration Peer::lookback() const { return config_.decisions.lookback ? *config_.decisions.lookback : longest_latency(); }

void Peer::measure_latency(Member& member, HostTime now, SimTime sent) {
  const SimTime came = clock_.to_session(now);
  const Duration late = sent >= came                 ? Duration{0}
                        : sent <= came - kLatencyMax ? Duration{kLatencyMax}  // before a difference could overflow
                                                     : came - sent;
  member.delays[member.delays_known++ % member.delays.size()] = late;
}

// None: where its object is then is not known.
std::optional<Pose> Peer::camera_pose(const Viewpoint& viewpoint, SimTime at) const {
  if (!viewpoint.object) return viewpoint.pose;
  if (!replica_->ghosts.has_history_at(*viewpoint.object, at)) return std::nullopt;
  const Pose carrier = replica_->ghosts.at(*viewpoint.object, at).pose();
  return Pose{carrier * viewpoint.pose.position, (carrier.orientation * viewpoint.pose.orientation).normalized()};
}

Contender Peer::contender(ObjectId object, SimTime at, std::span<const WorldBox> meeting) const {
  Contender s{owner(object), std::nullopt, own_latency(), false};
  const MotionWorld& ghosts = replica_->ghosts;
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
  // Both of them: who rides on one has that one in view wherever he looks.
  const collision::Camera camera{*from, viewpoint->field_of_view, viewpoint->aspect};
  s.sees = std::ranges::all_of(meeting, [&](const WorldBox& box) { return sees(camera, box); });
  return s;
}

PeerId Peer::choose_decider(ObjectId a, ObjectId b, SimTime contact) const {
  const SimTime at = decided_as_of(contact, lookback());
  std::vector<WorldBox> meeting;  // where the two then are
  for (const ObjectId object : {a, b}) {
    const collision::Body& body = *model_.body(object);
    const Vec3 center = replica_->ghosts.at(object, at).pose() * body.center;
    meeting.push_back(WorldBox{center.array() - body.radius_m, center.array() + body.radius_m});
  }
  const PeerId server = config_.decisions.server;
  const bool here = server == config_.id || members_.all().contains(server);
  return decider(config_.decisions.policy, contender(a, at, meeting), contender(b, at, meeting), here ? server : kNobody);
}

// Whether what is decided of it now reaches everybody in time.
bool Peer::reaches_all_in_time(SimTime contact) const { return contact >= tick_time(last_tick_) - kDecidedWithin; }

// Of a contact that the truth has found. What two others' objects do is nothing but a belief.
ContactAuthority Peer::contact_authority(ObjectId a, ObjectId b, SimTime contact) const {
  if (!has_two_owners(a, b) || !searches_contacts_of(a, b)) return ContactAuthority::kAsPublished;
  if (!reaches_all_in_time(contact)) return ContactAuthority::kDeferred;
  if (config_.decisions.policy == DecisionPolicy::kId) return ContactAuthority::kLocal;
  return choose_decider(a, b, contact) == config_.id ? ContactAuthority::kLocal : ContactAuthority::kDeferred;
}

void Peer::begin_worlds(SimTime now) {
  replica_.emplace(MotionWorld(model_, now), MotionWorld(model_, now));
  schedule_all_checks();
  if (!config_.display_delay.own) replica_->truth.keep_history_of_driven(kDrivenKept);
  replica_->truth.set_authority([this](ObjectId a, ObjectId b, SimTime contact) { return contact_authority(a, b, contact); });
}

// What spins up, or is hit by what goes as fast as can be, leaves the limits within which receivers take states. They
// would refuse the decision, and the whole datagram with it.
ContactEvent Peer::within_wire_limits(ContactEvent c) {
  for (KinematicState* const s : {&c.collider_before, &c.collidee_before, &c.collider_after, &c.collidee_after}) {
    if (acceptable(*s)) continue;
    *s = at_rest_within_limits(*s);
    ++counters_.states_out_of_range;
  }
  return c;
}

DecisionRecord Peer::record_of(const ContactEvent& c, DecisionRule rule) const {
  return {c.collider,
          c.collidee,
          c.at,
          c.normal,
          c.collider_before,
          c.collidee_before,
          c.collider_after,
          c.collidee_after,
          rule,
          decisions_.last(c.collider, c.collidee)};
}

std::vector<DecisionLog::Change> Peer::add_own_decision(const DecisionRecord& d) {
  ++counters_.decisions;
  auto changes = decisions_.add(d, config_.id);
  for (DecisionLog::Entry& e : decisions_.entries()) {
    const bool added =
        e.author == config_.id && e.record.contact == d.contact && of_pair(e.record, d.collider, d.collidee);
    if (added && e.in_force) e.copies = static_cast<int>(copies_against(loss(), kDecisionCopies));
  }
  return changes.value_or(std::vector<DecisionLog::Change>{});
}

// A contact that the truth has answered, for all. One that was decided here before and overruled, and is found again on
// the way that the others' decision gave, is another decision: a nanosecond later, for they are told apart by their
// times.
void Peer::decide(const ContactEvent& contact, SimTime known_at) {
  ContactEvent c = within_wire_limits(contact);
  while (const auto* known = decisions_.find(c.at, config_.id, c.collider, c.collidee)) {
    if (known->in_force) break;  // the same once more
    c.at += Duration{1};
  }
  const auto changes = add_own_decision(record_of(c, config_.decisions.policy));
  // As all who hear of it will: the own object's ghost too, or this peer's copy of their ghosts would not be theirs.
  replica_->ghosts.set_base(c.collider, c.at, law_of_outcome(model_.response_of(c.collider), c.collider_after));
  replica_->ghosts.set_base(c.collidee, c.at, law_of_outcome(model_.response_of(c.collidee), c.collidee_after));
  colliding_.on_contact(c);
  outputs_.push_back(ContactSeen{ContactKind::kDecided, c, known_at});
  const bool alone = changes.size() == 1 && changes.front().author == config_.id;
  if (!alone) apply_changes(changes, known_at);
}

// A contact just before one that has been decided is the same collision, found here by somewhat other states than the
// decider's: its decision has come before this peer's own tick.
void Peer::defer_contact(const ContactEvent& c) {
  const SimTime decided = decisions_.last(c.collider, c.collidee);
  if (decided >= c.at && decided <= c.at + DecisionLog::kSameCollision) return;
  if (!reaches_all_in_time(c.at)) {
    ++counters_.contacts_too_late;
    return;
  }
  ++counters_.contacts_held;
  deferred_contacts_.push_back({c, choose_decider(c.collider, c.collidee, c.at)});
}

bool Peer::awaits_decision_on(ObjectId object) const {
  return std::ranges::any_of(
      deferred_contacts_, [&](const DeferredContact& h) { return h.contact.collider == object || h.contact.collidee == object; });
}

// What this peer has found, and the one that is to decide it says nothing of, in time. The lower id decides; the other
// one where it was the lower one that said nothing, and else once a decision of the lower one would have come: it may
// not have found the contact.
void Peer::resolve_overdue_contacts(SimTime t) {
  decisions_.forget_before(t - kRememberedFor);
  const Duration patience = 2 * lookback() + 3 * config_.hello_period;
  const Duration lower_id_delay = lookback() + config_.hello_period;
  std::vector<DeferredContact> over;
  for (const DeferredContact& h : deferred_contacts_) {
    const PeerId lower = decider_by_id(owner(h.contact.collider), owner(h.contact.collidee));
    const Duration wait = members_.all().contains(h.decider) ? patience : Duration{0};
    const bool first = lower == config_.id || lower == h.decider;
    if (t >= h.contact.at + wait + (first ? Duration{0} : lower_id_delay)) over.push_back(h);
  }
  for (const DeferredContact& h : over) decide_by_fallback(h.contact, t);
}

void Peer::decide_by_fallback(const ContactEvent& c, SimTime known_at) {
  std::erase_if(deferred_contacts_, [&](const DeferredContact& h) {
    return h.contact.at == c.at && h.contact.collider == c.collider && h.contact.collidee == c.collidee;
  });
  if (!config_.decisions.fallback || !has_two_owners(c.collider, c.collidee)) return;
  if (!reaches_all_in_time(c.at)) {
    ++counters_.contacts_too_late;
    return;
  }
  ++counters_.decisions_fallback;
  apply_changes(add_own_decision(record_of(within_wire_limits(c), DecisionRule::kId)), known_at);
}

// Whether that peer may have found nothing because it has not heard how an own object came to the contact: it has not
// confirmed the last update from before it, or one that was replaced unconfirmed.
bool Peer::may_have_missed_our_update(PeerId peer, const ContactEvent& c) const {
  if (grid_.cuts()) return false;  // regions have no receipts
  return std::ranges::any_of(std::array{c.collider, c.collidee}, [&](ObjectId object) {
    const auto at = own_objects_.find(object);
    if (at == own_objects_.end() || !at->second.last_sent || at->second.acknowledged_by.contains(peer)) return false;
    return at->second.unacknowledged_by.contains(peer) || *at->second.last_sent <= c.at;
  });
}

// What the sender's hello says of contacts: whether it has found what this peer left to it.
void Peer::on_contact_notes(PeerId sender, const Hello& hello, SimTime known_at) {
  const Member& member = *members_.find(sender);
  const SimTime sent_at = known_at - member.delays[(member.delays_known - 1) % Member::kDelays];
  const std::vector<DeferredContact> waiting = deferred_contacts_;
  for (const DeferredContact& h : waiting) {
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
      std::erase_if(deferred_contacts_,
                    [&](const DeferredContact& other) { return other.contact.at == h.contact.at && other.decider == sender; });
    }
  }
}

// Whoever has just come may not know yet whose the objects are: as far as its receipts tell, the decision has not come.
void Peer::on_decision(PeerId sender, std::uint32_t number, const DecisionRecord& d, SimTime known_at) {
  if (!may_decide(sender, owner(d.collider), owner(d.collidee))) {
    members_.find(sender)->received[kWholeScene].mark_as_missing(number);
    return drop(sender, "not_decider");
  }
  if (decisions_.count(sender, d.collider, d.collidee) >= kOfPairMax) return drop(sender, "too_many_decisions");
  const auto changes = decisions_.add(d, sender);
  if (!changes) return drop(sender, "decision_known");
  if (changes->empty()) return drop(sender, "decision_overruled");
  apply_changes(*changes, known_at);
}

void Peer::apply_changes(const std::vector<DecisionLog::Change>& changes, SimTime known_at) {
  for (const DecisionLog::Change& change : changes) {
    const DecisionRecord& d = change.record;
    if (change.in_force) {
      apply_decision(d, change.author, known_at);
      continue;
    }
    ++counters_.decisions_overruled;
    outputs_.push_back(Overruled{d.collider, d.collidee, d.contact});
    for (const ObjectId object : {d.collider, d.collidee}) republish(object);
  }
}

// As of the contact time, not of arrival.
void Peer::apply_decision(const DecisionRecord& d, PeerId author, SimTime known_at) {
  std::erase_if(deferred_contacts_, [&](const DeferredContact& h) { return of_pair(d, h.contact.collider, h.contact.collidee); });
  for (const ObjectId object : {d.collider, d.collidee}) {
    rebase(object, d.contact);
    const auto own = own_objects_.find(object);
    if (own == own_objects_.end()) continue;
    if (own->second.last_sent && *own->second.last_sent > d.contact) republish(object);
  }
  if (!receives(d.collider) || !receives(d.collidee)) return;  // nobody is told of what is not heard of
  const ContactEvent contact{d.contact,         d.collider,        d.collidee,       d.normal,
                             d.collider_before, d.collidee_before, d.collider_after, d.collidee_after};
  colliding_.on_contact(contact);
  outputs_.push_back(
      ContactSeen{author == config_.id ? ContactKind::kDecided : ContactKind::kApplied, contact, known_at});
}

// The object's way from there on, by all that is known: the decisions that stand, and its owner's last update if that
// knew of them. Leaving out what came earlier but was heard later would leave a gap in which the two meet once more.
void Peer::rebase(ObjectId object, SimTime from) {
  const auto own = own_objects_.find(object);
  // What it met by itself from there on it may not have met.
  if (own != own_objects_.end() && !own->second.driven) outputs_.push_back(ContactsRetracted{object, from});
  SimTime last = from;
  for (const DecisionLog::Entry& e : decisions_.entries()) {
    const DecisionRecord& d = e.record;
    if (!e.in_force || d.contact < from || (d.collider != object && d.collidee != object)) continue;
    const MotionModel after =
        law_of_outcome(model_.response_of(object), d.collider == object ? d.collider_after : d.collidee_after);
    if (own != own_objects_.end() && !own->second.driven) replica_->truth.set_base(object, d.contact, after);
    set_ghost(object, d.contact, after);
    last = d.contact;
  }
  const auto last_update = last_updates_.find(object);
  if (own != own_objects_.end() || last_update == last_updates_.end()) return;
  const UpdateRecord& u = last_update->second;
  if (u.at > last && u.decision >= last && !decisions_.overruled(object, u.decision)) set_ghost(object, u.at, u.model);
}

// Everybody in the session, by their receipts.
bool Peer::is_acknowledged_by_all(const DecisionLog::Entry& own) const {
  return std::ranges::all_of(members_.all(), [&](const auto& member) {
    return !member.second.synchronised || own.acknowledged_by.contains(member.first);
  });
}

// Which of this peer's decisions the sender has, by its receipt. Whose last copy has surely not come there goes out
// again at once.
void Peer::on_acknowledgement(PeerId sender, const Acknowledgement& acknowledgement) {
  for (DecisionLog::Entry& e : decisions_.entries()) {
    if (e.author != config_.id || e.sent_in.empty() || e.acknowledged_by.contains(sender)) continue;
    if (std::ranges::any_of(e.sent_in, [&](std::uint32_t number) { return acknowledgement.has(number); })) {
      e.acknowledged_by.insert(sender);
    } else if (acknowledgement.surely_lost(e.sent_in.back())) {
      repeat(e);
    }
  }
}

// Those that everybody in the session could have confirmed, and somebody has not.
void Peer::repeat_unacknowledged_decisions() {
  if (!replica_) return;
  const SimTime answered = tick_time(last_tick_) - std::min<Duration>(answered_within(), kRepeatedFor / 2);
  std::map<std::pair<ObjectId, ObjectId>, int> newer;
  for (auto entry = decisions_.entries().rbegin(); entry != decisions_.entries().rend(); ++entry) {
    if (entry->author != config_.id || !entry->in_force || entry->record.contact > answered) continue;
    if (newer[std::minmax(entry->record.collider, entry->record.collidee)]++ >= kRepeatedOfPair) continue;
    if (!is_acknowledged_by_all(*entry)) repeat(*entry);
  }
}

void Peer::repeat(DecisionLog::Entry& own) {
  if (!config_.decisions.repeat || !own.in_force || own.copies > 0) return;
  if (own.record.contact < tick_time(last_tick_) - kRepeatedFor) return;
  own.copies = 1;
  ++counters_.decisions_repeated;
}

// What this peer holds, and what it has decided, until all have heard: who holds the same contact waits for it.
std::vector<ContactNote> Peer::contact_notes_to_send() {
  std::vector<ContactNote> notes;
  for (const DeferredContact& h : deferred_contacts_) {
    if (notes.size() == kNotesMax) return notes;
    notes.push_back({h.contact.collider, h.contact.collidee, h.contact.at, true});
  }
  const SimTime since = replica_ ? tick_time(last_tick_) - kAnnouncedFor : SimTime{};
  for (auto entry = decisions_.entries().rbegin(); entry != decisions_.entries().rend(); ++entry) {
    const DecisionRecord& d = entry->record;
    if (entry->author != config_.id || d.contact < since || is_acknowledged_by_all(*entry)) continue;
    if (notes.size() == kNotesMax) break;
    notes.push_back({d.collider, d.collidee, d.contact, false});
  }
  return notes;
}

}  // namespace peerd::replication
