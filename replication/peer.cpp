#include "replication/peer.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "collision/proximity.hpp"
#include "replication/decision.hpp"

namespace peerd::replication {
namespace {

constexpr RegionId kWholeScene{0};
// Hellos come faster until this peer has a session, so that joining takes tenths of a second.
constexpr Duration kJoiningHelloPeriod = std::chrono::milliseconds(100);
// A decision is not acknowledged; this many copies, one a tick, survive bursts of loss.
constexpr int kDecisionCopies = 3;
// An owner that has not taken up a decision for so long has never heard it: what it says counts again.
constexpr Duration kDecisionStands = std::chrono::seconds(2);
// An update from farther back than timelines reach, or from this far ahead, comes from a broken clock or a forger.
constexpr Duration kUpdateAgeMax = std::chrono::seconds(4);
constexpr Duration kUpdateAheadMax = std::chrono::seconds(1);
// What a datagram's header (version, sender, boot) leaves for records.
constexpr std::size_t kRecordsMax_bytes = kDatagramMax_bytes - 32;
// Per hello. 16 echoes of at most 26 bytes and 100 objects of at most 5 fit.
constexpr std::size_t kEchoesMax = 16;
constexpr std::size_t kEnslavedMax = 100;

// More peers than one network carries: somebody invents them.
constexpr std::size_t kMembersMax = 4096;
// After a longer gap between two ticks this peer was stopped, or its computer asleep. What would have happened
// meanwhile is not made up: for everybody else its objects stood still.
constexpr Duration kSlept = std::chrono::seconds(4);

}  // namespace

const char* to_string(Drop drop) {
  switch (drop) {
    case Drop::kOwn:
      return "own";
    case Drop::kUndecodable:
      return "undecodable";
    case Drop::kIdInUse:
      return "id_in_use";
    case Drop::kStaleBoot:
      return "stale_boot";
    case Drop::kOtherWorld:
      return "other_world";
    case Drop::kTooMany:
      return "too_many";
    case Drop::kStranger:
      return "stranger";
    case Drop::kNotYetInSession:
      return "not_yet_in_session";
  }
  return "?";
}

Peer::Peer(PeerConfig config, const WorldModel& model)
    : config_(std::move(config)), model_(model), members_(config_.lost_after) {
  assert(config_.id.value != 0 && config_.boot != 0 && config_.tick_hz > 0);
  for (const Enslaved& e : config_.enslaved) {
    own_[e.object].driven = e.driven;
    owners_[e.object] = config_.id;
  }
  outputs_.push_back(Join{kWholeScene});
}

// ---- what comes in ----

std::expected<void, Drop> Peer::on_packet(HostTime now, RegionId, std::span<const std::byte> datagram) {
  const auto dropped = [&](Drop why) {
    drop(to_string(why));
    return std::unexpected(why);
  };
  const auto message = decode(datagram);
  if (!message) {
    ++counters_.drops[std::string("undecodable_") + to_string(message.error())];  // which of them
    return dropped(Drop::kUndecodable);
  }
  const Message& m = *message;
  if (m.sender == config_.id) {
    if (m.boot == config_.boot) return std::unexpected(Drop::kOwn);  // no news: not counted
    // What this peer sent in its last life may still be under way.
    const bool just_started = !started_ || now - *started_ < config_.lost_after;
    if (m.boot < config_.boot && just_started) return dropped(Drop::kStaleBoot);
    if (!std::exchange(id_in_use_told_, true)) outputs_.push_back(IdInUse{m.sender});
    return dropped(Drop::kIdInUse);
  }
  const Member* known = members_.find(m.sender);
  if (known == nullptr && members_.all().size() == kMembersMax) return dropped(Drop::kTooMany);
  if (m.has_hello && m.hello.world_hash != config_.world_hash) {
    if (known != nullptr && m.boot < known->boot) return dropped(Drop::kStaleBoot);
    if (other_worlds_.size() == kMembersMax) other_worlds_.clear();
    if (other_worlds_.insert(m.sender).second) outputs_.push_back(OtherWorld{m.sender, m.hello.name});
    if (const auto member = members_.remove(m.sender)) lose(m.sender, member->name, now, true);
    return dropped(Drop::kOtherWorld);
  }
  if (!m.has_hello && known == nullptr) return dropped(Drop::kStranger);
  switch (members_.on_datagram(now, m.sender, m.boot)) {
    case Membership::Heard::kStale:
      return dropped(Drop::kStaleBoot);
    case Membership::Heard::kKnown:
      break;
    case Membership::Heard::kJoined:
      outputs_.push_back(PeerJoined{m.sender, m.hello.name, false});
      break;
    case Membership::Heard::kRestarted:
      release(m.sender, now);
      outputs_.push_back(PeerJoined{m.sender, m.hello.name, true});
      break;
  }
  ++counters_.datagrams_in;
  counters_.bytes_in += datagram.size();
  if (m.has_hello) on_hello(now, m.sender, m.hello);
  if (m.leaving) {
    lose(m.sender, members_.remove(m.sender)->name, now, true);
    return {};
  }
  if (!replica_) {
    if (m.updates.empty() && m.decisions.empty()) return {};
    return dropped(Drop::kNotYetInSession);
  }
  const SimTime session_now = clock_.to_session(now);
  for (const UpdateRecord& u : m.updates) {
    if (u.at < session_now - kUpdateAgeMax || u.at > session_now + kUpdateAheadMax) {
      drop("update_time");
    } else {
      on_update(m.sender, u);
    }
  }
  for (const DecisionRecord& d : m.decisions) {
    if (d.contact < session_now - kUpdateAgeMax || d.contact > session_now + kUpdateAheadMax) {
      drop("decision_time");
    } else {
      on_decision(m.sender, d, session_now);
    }
  }
  return {};
}

void Peer::on_hello(HostTime now, PeerId sender, const Hello& hello) {
  Member& member = *members_.find(sender);
  member.name = hello.name;
  member.hello_tx = hello.host_tx;
  member.hello_rx = now;
  if (hello.sessions != member.sessions) {  // it knows of no updates yet
    for (auto& [object, own] : own_) own.resend = true;
  }
  member.sessions = hello.sessions;
  member.synchronised = hello.synchronised;
  member.session_minus_host = hello.session_minus_host;
  member.start = hello.start;
  if (hello.synchronised) claim(sender, hello.enslaved);

  const std::optional<PeerId> lowest = members_.lowest_synchronised();
  const bool lead = clock_.synchronised() && (!lowest || config_.id < *lowest);
  const std::optional<PeerId> follow = lead ? std::optional(config_.id) : lowest;
  if (follow != follows_) {
    follows_ = follow;
    clock_.follow_another();
  }
  if (follows_ != sender) return;
  const auto echo = std::ranges::find(hello.echoes, config_.id, &ClockEcho::peer);
  if (echo == hello.echoes.end()) return;
  clock_.on_exchange({echo->their_tx, echo->our_rx, hello.host_tx, now, hello.session_minus_host});
  if (clock_.synchronised() && !replica_) {
    outputs_.push_back(Synchronised{sender, clock_.session_minus_host(), clock_.error_bound()});
    enter_session(now);
  }
}

// Nobody runs an object that somebody else runs already; of two who both say so the lower id is believed.
void Peer::claim(PeerId peer, std::span<const ObjectId> objects) {
  bool changed = false;
  for (ObjectId object : objects) {
    if (object.value >= model_.scene->instances.size()) {
      drop("object");
      continue;
    }
    const auto [at, added] = owners_.try_emplace(object, peer);
    const bool taken = !added && peer < at->second;
    if (taken) {
      outputs_.push_back(OwnershipConflict{object, peer});
      if (at->second == config_.id) own_.erase(object);
      at->second = peer;
    }
    if (!added && !taken) continue;
    changed = true;
    if (replica_) {
      replica_->truth.declare(object, Role::kBelief);
      replica_->ghosts.declare(object, Role::kBelief);
    }
  }
  if (changed) watch_decided_pairs();
}

void Peer::lose(PeerId peer, const std::string& name, HostTime now, bool said_goodbye) {
  release(peer, now);
  if (follows_ == peer) follows_.reset();
  outputs_.push_back(PeerLost{peer, name, said_goodbye});
}

// What a lost peer ran stands still from now on, and belongs to nobody.
void Peer::release(PeerId peer, HostTime now) {
  const SimTime t = clock_.to_session(now);
  for (auto at = owners_.begin(); at != owners_.end();) {
    if (at->second != peer) {
      ++at;
      continue;
    }
    if (replica_) {
      set_ghost(at->first, t, at_rest(replica_->ghosts.at(at->first, t).pose()));
      replica_->truth.declare(at->first, Role::kScene);
      replica_->ghosts.declare(at->first, Role::kScene);
      outputs_.push_back(Frozen{at->first, peer});
    }
    at = owners_.erase(at);
  }
  watch_decided_pairs();
}

void Peer::on_update(PeerId sender, const UpdateRecord& u) {
  if (owner(u.object) == kNobody) claim(sender, {&u.object, 1});  // its hello may have been lost
  if (owner(u.object) != sender) return drop("not_owner");
  std::uint32_t& last = members_.find(sender)->last_sequence[u.object];
  if (u.sequence == last) {
    ++counters_.updates_duplicate;
    return;
  }
  if (u.sequence < last) return drop("old_sequence");
  last = u.sequence;
  ++counters_.updates_in;
  const SimTime decided = last_decision(u.object);
  if (u.decision < decided && u.at < decided + kDecisionStands) return drop("before_decision");
  set_ghost(u.object, u.at, u.state);
}

void Peer::on_decision(PeerId sender, const DecisionRecord& d, SimTime known_at) {
  const PeerId owner_a = owner(d.collider), owner_b = owner(d.collidee);
  if (owner_a == kNobody || owner_b == kNobody || decider_by_id(owner_a, owner_b) != sender) return drop("not_decider");
  if (d.contact <= last_decision(d.collider) && d.contact <= last_decision(d.collidee)) return drop("decision_known");
  for (const auto& [object, after] :
       {std::pair{d.collider, &d.collider_after}, std::pair{d.collidee, &d.collidee_after}}) {
    if (d.contact <= last_decision(object)) continue;
    decisions_[object] = d.contact;
    const auto own = own_.find(object);
    if (own != own_.end() && !own->second.driven) replica_->truth.set_base(object, d.contact, *after);
    set_ghost(object, d.contact, *after);
  }
  outputs_.push_back(ContactSeen{ContactKind::kApplied,
                                 {d.contact, d.collider, d.collidee, d.normal, d.collider_before, d.collidee_before,
                                  d.collider_after, d.collidee_after},
                                 known_at});
}

void Peer::set_ghost(ObjectId object, SimTime t, const KinematicState& state) {
  replica_->ghosts.set_base(object, t, state);
  if (!own_.contains(object)) replica_->truth.set_base(object, t, state);
}

// ---- session ----

void Peer::enter_session(HostTime host_now) {
  const SimTime now = clock_.to_session(host_now);
  ++sessions_;
  next_hello_ = host_now;
  replica_.emplace(MotionWorld(model_, now), MotionWorld(model_, now));
  last_tick_ = tick_number(now);
  declare_all();
  for (const auto& [object, own] : own_) {
    KinematicState initial = at_rest(model_.scene->rigid_pose(object));
    if (!own.driven && !config_.wait_for_start) initial.velocity = model_.scene->at(object).velocity;
    replica_->truth.set_base(object, now, initial);
  }
}

void Peer::start_motions(HostTime now, SimTime start) {
  if (!replica_) return;
  const SimTime from = std::max(start, clock_.to_session(now));
  for (auto& [object, own] : own_) {
    if (own.driven) continue;
    KinematicState state = replica_->truth.at(object, from);
    state.velocity = model_.scene->at(object).velocity;
    replica_->truth.set_base(object, from, state);
    own.starts = from;
  }
}

void Peer::declare_all() {
  for (const auto& [object, peer] : owners_) {
    const auto own = own_.find(object);
    const bool ours = own != own_.end();
    replica_->truth.declare(object, !ours ? Role::kBelief : own->second.driven ? Role::kDriven : Role::kFirm);
    replica_->ghosts.declare(object, Role::kBelief);
  }
  watch_decided_pairs();
}

// The clock has stepped into another session, or this computer has slept. Everything goes on from where it is, at the
// other session's time; what was known of the past, and what the others were told in the old time, is void.
void Peer::change_session(SimTime before, SimTime now) {
  const Replica old = std::move(*replica_);
  ++sessions_;
  next_hello_ = clock_.to_host(now);
  replica_.emplace(MotionWorld(model_, now), MotionWorld(model_, now));
  last_tick_ = tick_number(now);
  decisions_.clear();
  decisions_due_.clear();
  declare_all();
  for (const ObjectId object : old.ghosts.objects()) {
    if (!replica_->ghosts.has(object)) {  // frozen: nobody runs it, no interest names it
      replica_->truth.declare(object, Role::kScene);
      replica_->ghosts.declare(object, Role::kScene);
    }
    replica_->truth.set_base(object, now, old.truth.at(object, before));
    replica_->ghosts.set_base(object, now, old.ghosts.at(object, before));
  }
  for (auto& [object, own] : own_) own.last_sent.reset();
}

// The truth watches what this peer decides. Ghosts are watched wherever they may meet something, own ones included:
// the sender must know what every receiver predicts, or a predicted collision would cost an update.
void Peer::watch_decided_pairs() {
  if (!replica_) return;
  const auto ours = [&](ObjectId id) { return own_.contains(id); };
  std::set<ObjectId> partners;  // remote objects whose collisions with ours this peer decides
  for (const CollisionPair& pair : model_.pairs) {
    const PeerId a = owner(pair.collider), b = owner(pair.collidee);
    if (ours(pair.collider) == ours(pair.collidee) || decider_by_id(a, b) != config_.id) continue;
    partners.insert(ours(pair.collider) ? pair.collidee : pair.collider);
  }
  for (const CollisionPair& pair : model_.pairs) {
    const bool mine = ours(pair.collider) || ours(pair.collidee);
    const bool decided_here = decider_by_id(owner(pair.collider), owner(pair.collidee)) == config_.id;
    const bool partner = partners.contains(pair.collider) || partners.contains(pair.collidee);
    replica_->truth.watch(pair.collider, pair.collidee, mine ? decided_here : partner);
    replica_->ghosts.watch(pair.collider, pair.collidee, config_.policy.predict_collisions);
  }
}

// False when everything begins anew at this instant, and what was due is not.
bool Peer::keep_session(HostTime now) {
  if (!started_) {
    started_ = now;
    next_hello_ = now;
  }
  if (const Duration gap = replica_ ? clock_.to_session(now) - tick_time(last_tick_) : Duration{0}; gap > kSlept) {
    counters_.ticks_missed += static_cast<std::uint64_t>(tick_number(clock_.to_session(now)) - last_tick_);
    members_.excuse(now);  // it was not they who were silent
    change_session(tick_time(last_tick_), clock_.to_session(now));
    outputs_.push_back(Slept{gap});
    return false;
  }
  for (auto& [peer, member] : members_.expire(now)) {
    lose(peer, member.name, now, false);
  }
  if (!clock_.synchronised() && now - *started_ >= config_.listen_first && !members_.lowest_synchronised()) {
    const bool lowest = members_.all().empty() || config_.id < members_.all().begin()->first;
    if (lowest) {
      clock_.found_session();
      follows_ = config_.id;
      outputs_.push_back(Synchronised{config_.id, Duration{0}, Duration{0}});
      enter_session(now);
    }
  }
  const SimTime before = clock_.to_session(now);
  if (clock_.adjust(now)) {
    const SimTime after = clock_.to_session(now);
    if (replica_) change_session(before, after);
    outputs_.push_back(ClockStepped{clock_.session_minus_host(), after - before});
    return false;
  }
  return true;
}

void Peer::look(SimTime t) {
  if (replica_) replica_->ghosts.advance(t);
}

void Peer::leave(HostTime now) {
  flush_records(true);
  send_hello(now, true);
}

// ---- a tick ----

std::int64_t Peer::tick_number(SimTime t) const {
  const std::int64_t ns = t.time_since_epoch().count();
  const std::int64_t second = 1'000'000'000;
  const std::int64_t whole = ns >= 0 ? ns / second : (ns - second + 1) / second;
  const std::int64_t rest = ns - whole * second;
  // The last k with tick_time(k) <= t; tick_time rounds down, so a tick's own time must give the tick back.
  return whole * config_.tick_hz + ((rest + 1) * config_.tick_hz - 1) / second;
}

SimTime Peer::tick_time(std::int64_t number) const {
  const std::int64_t hz = config_.tick_hz;
  const std::int64_t whole = number >= 0 ? number / hz : (number - hz + 1) / hz;
  return SimTime{std::chrono::seconds(whole) + Duration{(number - whole * hz) * 1'000'000'000 / hz}};
}

std::optional<SimTime> Peer::due_tick(HostTime now) const {
  if (!replica_) return std::nullopt;
  const std::int64_t number = tick_number(clock_.to_session(now));
  if (number <= last_tick_) return std::nullopt;
  return tick_time(number);
}

void Peer::on_tick(HostTime now, std::span<const OwnSample> samples) {
  const std::optional<SimTime> due = due_tick(now);
  const bool ticks = keep_session(now) && due;
  if (ticks) {
    const std::int64_t number = tick_number(*due);
    ++counters_.ticks;
    counters_.ticks_missed += static_cast<std::uint64_t>(number - last_tick_ - 1);
    last_tick_ = number;
    tick(*due, samples);
  }
  if (now >= *next_hello_) {  // before the records: who has not heard of a peer can't use its updates
    send_hello(now, false);
    repeat_updates();
    next_hello_ = now + (replica_ ? config_.hello_period : kJoiningHelloPeriod);
  }
  flush_records(ticks);
}

void Peer::tick(SimTime t, std::span<const OwnSample> samples) {
  replica_->truth.advance(t);
  for (const OwnSample& sample : samples) {
    const auto own = own_.find(sample.object);
    if (own == own_.end()) continue;  // lost to another peer
    assert(own->second.driven);
    replica_->truth.set_base(sample.object, t, sample.state);
  }
  replica_->ghosts.advance(t);
  report_contacts(t);
  publish(t);
}

void Peer::report_contacts(SimTime t) {
  while (const auto event = replica_->truth.poll_event()) {
    const auto* contact = std::get_if<ContactEvent>(&*event);
    if (contact == nullptr) continue;
    const bool a = own_.contains(contact->collider), b = own_.contains(contact->collidee);
    if (!a && !b) continue;  // a partner's own contacts; the ghosts tell of them
    const bool shared = a != b && owner(contact->collider) != kNobody && owner(contact->collidee) != kNobody;
    if (shared) decide(*contact);
    outputs_.push_back(ContactSeen{shared ? ContactKind::kDecided : ContactKind::kOwner, *contact, t});
  }
  const auto others = [&](ObjectId id) { return !own_.contains(id) && owner(id) != kNobody; };
  while (const auto event = replica_->ghosts.poll_event()) {
    if (const auto* taken_back = std::get_if<TakenBack>(&*event)) {
      if (others(taken_back->object)) outputs_.push_back(*taken_back);
    } else if (const auto& contact = std::get<ContactEvent>(*event);
               others(contact.collider) || others(contact.collidee)) {
      outputs_.push_back(ContactSeen{ContactKind::kPredicted, contact, t});
    }
  }
}

void Peer::decide(const ContactEvent& c) {
  std::erase_if(decisions_due_, [&](const auto& due) {  // of one pair, the last outcome counts
    return due.first.collider == c.collider && due.first.collidee == c.collidee;
  });
  decisions_due_.emplace_back(DecisionRecord{c.collider, c.collidee, c.at, c.normal, c.collider_before,
                                             c.collidee_before, c.collider_after, c.collidee_after, DecisionRule::kId},
                              kDecisionCopies);
  decisions_[c.collider] = decisions_[c.collidee] = c.at;
  // As all who hear of it will: the own object's ghost too, or this peer's copy of their ghosts would not be theirs.
  replica_->ghosts.set_base(c.collider, c.at, c.collider_after);
  replica_->ghosts.set_base(c.collidee, c.at, c.collidee_after);
}

SimTime Peer::last_decision(ObjectId object) const {
  const auto at = decisions_.find(object);
  return at == decisions_.end() ? SimTime{} : at->second;
}

bool Peer::in_close_proximity(ObjectId object, SimTime t) {
  const collision::Body* body = model_.body(object);
  if (body == nullptr) return false;
  const KinematicState state = replica_->truth.at(object, t);
  return std::ranges::any_of(model_.pairs, [&](const CollisionPair& pair) {
    if (pair.collider != object && pair.collidee != object) return false;
    const ObjectId other = pair.collider == object ? pair.collidee : pair.collider;
    const PeerId other_owner = owner(other);
    if (other_owner == kNobody || other_owner == config_.id) return false;  // seed, table 4.1: remote-enslaved only
    ++counters_.proximity_tests;
    const KinematicState other_state = replica_->truth.at(other, t);
    return collision::proximity_time_s({*body, state}, {*model_.body(other), other_state}) <
           config_.policy.close_proximity_s;
  });
}

void Peer::publish(SimTime t) {
  const PublishPolicy& policy = config_.policy;
  for (auto& [object, own] : own_) {
    const KinematicState truth = replica_->truth.at(object, t);
    const GhostError error = ghost_error(truth, replica_->ghosts.at(object, t));
    double threshold_m = policy.error_threshold_m.value_or(model_.scene->at(object).distance_threshold_m);
    if (policy.track_proximity && in_close_proximity(object, t)) {
      threshold_m = std::min(threshold_m, policy.tight_threshold_m);
    }
    if (own.starts && t >= *own.starts) {  // it has begun to move: nobody could know
      own.starts.reset();
      own.last_sent.reset();
    }
    std::optional<PublishReason> reason = due(policy, threshold_m, error, own.last_sent, t);
    if (!reason && own.resend) reason = PublishReason::kJoiner;
    if (!reason) continue;
    own.last_sent = t;
    own.resend = false;
    const UpdateRecord record{
        object, ++own.sequence, t, policy.order, as_model(policy.order, truth), last_decision(object)};
    replica_->ghosts.set_base(object, t, record.state);
    ++counters_.updates_out;
    outputs_.push_back(Published{t, object, encoded_size_bytes(record), threshold_m, *reason});
    updates_due_.push_back(record);
    own.to_repeat = record;
  }
}

// A state that nothing newer has replaced goes out once more with the next hello: a lost one would stand wrong until
// the time threshold. Where updates come fast there is nothing to repeat.
void Peer::repeat_updates() {
  for (auto& [object, own] : own_) {
    if (!own.to_repeat) continue;
    const bool due_anyway =
        std::ranges::any_of(updates_due_, [&](const UpdateRecord& u) { return u.object == object; });
    if (due_anyway) continue;  // it goes out for the first time just now
    updates_due_.push_back(*std::exchange(own.to_repeat, std::nullopt));
    ++counters_.updates_repeated;
  }
}

// ---- what goes out ----

Message Peer::blank() const {
  Message m;
  m.sender = config_.id;
  m.boot = config_.boot;
  return m;
}

// Updates and decisions, as few datagrams as hold them. A decision's copies go out a tick apart.
void Peer::flush_records(bool decisions) {
  Message m = blank();
  std::size_t used_bytes = 0;
  const auto make_room = [&](std::size_t size_bytes) {
    if (used_bytes > 0 && used_bytes + size_bytes > kRecordsMax_bytes) {
      send(m);
      m = blank();
      used_bytes = 0;
    }
    used_bytes += size_bytes;
  };
  for (const UpdateRecord& update : updates_due_) {
    make_room(encoded_size_bytes(update));
    m.updates.push_back(update);
  }
  updates_due_.clear();
  for (auto& [decision, copies] : decisions_due_) {
    if (!decisions) break;
    make_room(encoded_size_bytes(decision));
    m.decisions.push_back(decision);
    --copies;
  }
  std::erase_if(decisions_due_, [](const auto& due) { return due.second == 0; });
  if (used_bytes > 0) send(m);
}

void Peer::send_hello(HostTime now, bool leaving) {
  Message m = blank();
  m.has_hello = true;
  m.leaving = leaving;
  m.hello = {
      config_.name, config_.world_hash, now, clock_.synchronised(), clock_.session_minus_host(), sessions_, {}, {},
      start_};
  // Lists too long for one datagram take turns, hello by hello.
  const auto turns = [&](std::size_t size, std::size_t most, auto take) {
    for (std::size_t i = 0; i < std::min(size, most); ++i) take((hellos_ * most + i) % size);
  };
  std::vector<ClockEcho> echoes;
  for (const auto& [peer, member] : members_.all()) {
    if (member.hello_tx) echoes.push_back({peer, *member.hello_tx, *member.hello_rx});
  }
  turns(echoes.size(), kEchoesMax, [&](std::size_t i) { m.hello.echoes.push_back(echoes[i]); });
  std::vector<ObjectId> enslaved;
  for (const auto& [object, own] : own_) enslaved.push_back(object);
  turns(enslaved.size(), kEnslavedMax, [&](std::size_t i) { m.hello.enslaved.push_back(enslaved[i]); });
  ++hellos_;
  send(m);
}

void Peer::send(const Message& message) {
  Bytes datagram = encode(message);
  assert(datagram.size() <= kDatagramMax_bytes);
  ++counters_.datagrams_out;
  counters_.bytes_out += datagram.size();
  outputs_.push_back(Send{kWholeScene, std::move(datagram)});
}

std::optional<Output> Peer::poll_output() {
  if (outputs_.empty()) return std::nullopt;
  Output out = std::move(outputs_.front());
  outputs_.pop_front();
  return out;
}

HostTime Peer::next_deadline() const {
  if (!next_hello_) return HostTime::min();
  HostTime next = *next_hello_;
  if (replica_) next = std::min(next, clock_.to_host(tick_time(last_tick_ + 1)));
  if (const auto expiry = members_.next_expiry()) next = std::min(next, *expiry);
  return next;
}

// ---- questions ----

PeerId Peer::owner(ObjectId object) const {
  const auto at = owners_.find(object);
  return at == owners_.end() ? kNobody : at->second;
}

KinematicState Peer::truth(ObjectId object, SimTime t) const {
  assert(replica_);
  return replica_->truth.has(object) ? replica_->truth.at(object, t) : at_rest(model_.scene->rigid_pose(object));
}

KinematicState Peer::ghost(ObjectId object, SimTime t) const {
  assert(replica_);
  return replica_->ghosts.has(object) ? replica_->ghosts.at(object, t) : at_rest(model_.scene->rigid_pose(object));
}

MotionWorld::Counters Peer::motion_counters() const {
  MotionWorld::Counters sum;
  if (replica_) (sum += replica_->truth.counters()) += replica_->ghosts.counters();
  return sum;
}

}  // namespace peerd::replication
