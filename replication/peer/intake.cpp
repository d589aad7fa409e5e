#include "replication/peer/intake.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <string>
#include <utility>

#include "replication/objects/contacts/decision.hpp"
#include "replication/wire/hello_lists.hpp"
#include "replication/wire/wire_limits.hpp"

namespace peerd::replication {
namespace {

// A decision may be of what happened up to 3 s ago (contact_decisions.cpp), and repeated where datagrams get lost.
constexpr Duration kDecisionAgeMax = MotionWorld::kHistory;

// A far hello may promise the next one within so long at least: twice the longest interval of hellos that a peer can
// have.
constexpr Duration kLeastFarPromise = std::chrono::seconds(8);

// Records of many instants advance the worlds to each of these, up to this often in a tick. The others wait until the
// tick has.
constexpr int kAdvancesMax = 64;

// How long a record with a future time stamp is remembered against its sender.
constexpr Duration kAheadForgotten = std::chrono::minutes(1);

// The delay of a hello, in session time; a negative one counts as 0, and one longer than any latency as kLatencyMax.
Duration delay_of(SimTime sent, SimTime came) {
  if (sent >= came) return Duration{0};
  if (sent <= came - kLatencyMax) return Duration{kLatencyMax};  // before a difference could overflow
  return came - sent;
}

// The kind by which it is counted: the first of these that it has.
DatagramKind kind_of(const Message& m) {
  if (m.next_hello) return DatagramKind::kFarHello;
  if (m.hello) return DatagramKind::kHello;
  if (!m.decisions.empty()) return DatagramKind::kDecisions;
  if (!m.subscriptions.empty()) return DatagramKind::kSubscriptions;
  if (!m.scene.states.empty()) return DatagramKind::kSceneStates;
  if (!m.operations.empty() || !m.operation_requests.empty()) return DatagramKind::kOperations;
  if (!m.handovers.empty()) return DatagramKind::kHandovers;
  return m.updates.empty() ? DatagramKind::kKeepalive : DatagramKind::kUpdates;
}

}  // namespace

std::unexpected<Drop> Intake::dropped(RegionId region, Drop why) {
  if (why != Drop::kOwn) {  // a datagram that comes back by loopback is no news
    ++p_.counters.drops[to_string(why)];
    ++p_.counters.regions[region].drops[to_string(why)];
  }
  return std::unexpected(why);
}

std::expected<void, Drop> Intake::on_packet(HostTime now, RegionId region, std::span<const std::byte> datagram) {
  (void)keeper_.check_suspension(now);  // the datagram is read by the session time that goes on
  const auto message = codec_.decode(datagram, p_.to_session(now));
  if (!message) {
    ++p_.counters.drops[std::string("undecodable_") + to_string(message.error())];  // counts the kind of error
    if (message.error() == DecodeError::kVersion) p_.admission.on_other_version(codec_.sender(), codec_.version());
    return dropped(region, Drop::kUndecodable);
  }
  Message& m = **message;
  assert(m.sender != kNobody);
  if (m.identity) return dropped(region, p_.admission.on_identity_check(now, m));
  const bool for_all = m.hello || m.leaving || !m.decisions.empty() || !m.subscriptions.empty() ||
                       !m.scene.states.empty() || !m.operations.empty() || !m.operation_requests.empty() ||
                       m.ghost_question || !m.ghost_answer.states.empty() || !m.ghost_reports.empty();
  if (m.nearby ? region == kWholeScene : for_all && region != kWholeScene) return dropped(region, Drop::kRegion);
  if (m.next_hello && (m.nearby || !m.hello)) return dropped(region, Drop::kRegion);
  const auto admitted = admit(now, region, m);
  if (!admitted) return dropped(region, admitted.error());
  if (!p_.limits.take(now, m.sender, MemberLimit::kDatagrams)) return dropped(region, Drop::kMemberLimit);
  count(region, m, datagram.size());
  if (!*admitted) {
    on_far(now, m.sender, m);
    return {};
  }
  Member& member = *p_.members.find(m.sender);
  ++member.datagrams_in;
  member.bytes_in += datagram.size();
  member.is_near = true;
  member.channel = m.nearby ? kNearby : region;
  LossMeter& received = member.received[member.channel];
  // A peer that listens to several of the sender's regions gets as many copies.
  const bool is_copy = m.nearby && received.received().has(m.number);
  if (m.number > 0) received.on_datagram(m.number);
  if (is_copy) return {};
  if (m.hello) on_hello(now, m.sender, m.number, *m.hello);
  operations_.on_message(now, m.sender, m);
  if (m.leaving) {
    const Member left = p_.admission.dismiss(m.sender);
    keeper_.lose(m.sender, left, now, true);
    return {};
  }
  if (!p_.replica.begun()) {
    if (m.updates.empty() && m.decisions.empty() && m.scene.states.empty()) return {};
    return dropped(region, Drop::kNotYetInSession);
  }
  on_records(now, m.sender, m, p_.to_session(now));
  on_ghost_checks(region, m, p_.to_session(now));
  return {};
}

void Intake::on_ghost_checks(RegionId region, const Message& m, SimTime session_now) {
  if (m.ghosts) p_.ghost_check.on_digest(m.sender, region, *m.ghosts, session_now);
  if (m.ghost_question) p_.ghost_check.on_question(m.sender, *m.ghost_question, session_now);
  if (!m.ghost_answer.states.empty()) p_.ghost_check.on_answer(m.sender, m.ghost_answer, session_now);
  if (!m.ghost_reports.empty()) p_.ghost_check.on_reports(m.sender, m.ghost_reports, session_now);
}

void Intake::count(RegionId region, const Message& m, std::size_t size_bytes) {
  ++p_.counters.datagrams_in;
  p_.counters.bytes_in += size_bytes;
  PeerCounters::Traffic& traffic = p_.counters.regions[region];
  ++traffic.datagrams_in;
  traffic.bytes_in += size_bytes;
  PeerCounters::Volume& volume = p_.counters.kinds_in[static_cast<std::size_t>(kind_of(m))];
  ++volume.datagrams;
  volume.bytes += size_bytes;
}

std::expected<bool, Drop> Intake::admit(HostTime now, RegionId region, const Message& m) {
  const auto on_lost = [&](PeerId peer, const OtherPeer& gone) { keeper_.lose(peer, gone, now, true); };
  const bool leads = p_.time.follows() == p_.config.id;
  p_.admission.follow(!p_.logs.empty(), p_.replica.begun());
  const std::uint64_t line = p_.admission.line();
  const auto admission = p_.admission.admit(now, region, m, leads, p_.time.started(), on_lost);
  if (p_.admission.line() != line) keeper_.reintroduce();
  if (!admission) {
    if (admission.error() == Drop::kOtherLine) {  // one of the two gives way, once it knows this peer
      p_.greeter.settle_from(now);
      p_.greeter.introduce_once();
      return std::unexpected(admission.error());
    }
    if (admission.error() == Drop::kUnintroduced && p_.members.is_large()) {
      // Its far hello says who it is; this peer's next hello may go where it listens.
      if (region != kWholeScene) p_.greeter.introduce_once();
      return std::unexpected(admission.error());
    }
    // A sender that does not introduce itself does not know this peer: it will answer this peer's introduction.
    if (admission.error() == Drop::kUnintroduced && !p_.admission.has_other_world(m.sender) &&
        !p_.admission.has_other_line(m.sender)) {
      p_.time.on_unintroduced_peer(now);
      p_.greeter.settle_from(now);
      p_.greeter.introduce_once();
    }
    return std::unexpected(admission.error());
  }
  if (*admission == Membership::Admission::kFar) return false;
  if (*admission == Membership::Admission::kNear) p_.exchange.on_joined(m.sender);
  if (*admission == Membership::Admission::kKnown || *admission == Membership::Admission::kNear) return true;
  assert(*admission == Membership::Admission::kJoined || *admission == Membership::Admission::kRestarted);
  const bool restarted = *admission == Membership::Admission::kRestarted;
  p_.greeter.settle_from(now);
  p_.own.check_all();  // a peer is here that does not have the last updates of resting objects
  if (restarted) keeper_.orphan_objects_of(m.sender, now, now, true);
  keeper_.give_as_operations_say();
  p_.exchange.on_joined(m.sender);
  p_.outbox.push(PeerJoined{m.sender, m.introduction()->name, restarted});
  return true;
}

// ---- far peers of a large session ----

void Intake::on_far(HostTime now, PeerId sender, const Message& m) {
  assert(sender != p_.config.id && (m.hello || !m.next_hello));
  if (m.leaving) return keeper_.dismiss_far(sender, now);
  // No peer promises a longer interval than that of kMembersMax peers. A peer that promises none says hello as often as
  // in a small session.
  const Duration most = std::max(kLeastFarPromise, from_seconds(2.0 * kMembersMax / p_.config.large.hellos_per_s));
  const Duration patience = m.next_hello
                                ? kFarHellosMissed * std::min<Duration>(*m.next_hello, most) + p_.config.lost_after
                                : 2 * p_.config.lost_after;
  const auto expect = [&](OtherPeer& other) {
    const bool is_newer = m.next_hello && m.number > other.far_hello.number;  // a new leader promises less
    other.expected_until = is_newer ? now + patience : std::max(other.expected_until, now + patience);
    if (m.hello) other.promises_hellos = m.next_hello.has_value();
  };
  if (Member* const member = p_.members.find(sender)) {
    expect(*member);
    if (m.number > 0) member->received[kWholeScene].on_datagram(m.number);
    if (m.hello && !m.hello->logs.empty()) operations_.on_message(now, sender, m);
    return on_far_hello(now, sender, *member, m);
  }
  const Introduction* const introduction = m.introduction();
  FarPeer* far = p_.members.find_far(sender);
  if (far == nullptr) {
    assert(introduction != nullptr && "an unknown peer introduces itself");
    const auto [noted, is_new] = p_.members.note_far(now, sender, m.incarnation);
    far = noted;
    report_same_name(sender, introduction->name);
    p_.outbox.push(PeerJoined{sender, introduction->name, false});
  }
  expect(*far);
  if (!m.hello) return;
  far->synchronised = m.hello->session_tx.has_value();
  far->sessions = m.hello->sessions;
  far->far_hello.receive(m.number, now);
  if (introduction != nullptr) {
    far->name = introduction->name;
    far->start = introduction->start;
    std::vector<ObjectId> all;
    std::ranges::set_union(far->owned, introduction->owned, std::back_inserter(all));
    std::erase_if(all, [&](ObjectId object) { return !p_.model->scene->contains(object); });
    far->owned = std::move(all);
    give_back_left_behind(sender, introduction->owned);
  }
  if (!m.hello->logs.empty()) operations_.on_message(now, sender, m);
  // The time of a leader counts, however far it is, and so does that of the lowest peer, which is to lead.
  const bool leads = m.hello->session_tx && !m.hello->clock_error;
  const bool is_lower = sender < p_.config.id || !p_.time.clock().synchronised();
  if (!leads && !(is_lower && p_.members.lowest() == sender)) return;
  assert(far->incarnation == m.incarnation || introduction == nullptr);
  Member& leading = p_.members.promote(now, sender, false);
  p_.exchange.on_joined(sender);
  leading.far_hello.number = 0;  // this hello counts for the member
  on_far_hello(now, sender, leading, m);
}

// A far peer that was taken for gone, for it was silent where this peer listens, goes on to own what it says.
void Intake::give_back_left_behind(PeerId sender, std::span<const ObjectId> owned) {
  std::vector<ObjectId> back;
  std::ranges::copy_if(owned, std::back_inserter(back), [&](ObjectId object) {
    const auto left = p_.left_behind.find(object);
    return left != p_.left_behind.end() && left->second.owner == sender && p_.owners.of(object) == kNobody;
  });
  if (!back.empty()) keeper_.claim(sender, back);
}

// The hello says nothing about what is received of this peer, but it may echo this peer's last far hello.
void Intake::on_far_hello(HostTime now, PeerId sender, Member& member, const Message& m) {
  if (!m.hello) return;
  const Hello& hello = *m.hello;
  if (m.number <= member.far_hello.number) return;
  member.far_hello.receive(m.number, now);
  if (!hello.echoes.empty()) member.echoing = now;
  member.synchronised = hello.session_tx.has_value();  // one that has just joined may be near no more
  if (!member.is_near) {
    member.hello_rx = now;
    member.latency = hello.latency;
    member.sessions = hello.sessions;
  }
  if (hello.introduction) on_introduction(now, sender, member, hello);
  const auto zero = hello.introduction && hello.session_tx ? hello.introduction->world_zero : std::nullopt;
  if (zero && p_.time.follows() == sender && p_.world_time.on_zero(sender, p_.time.follows(), *zero)) {
    keeper_.reintroduce();
    p_.scripted.restart();
  }
  const auto named = std::ranges::find(hello.echoes, p_.config.id, &Echo::peer);
  std::optional<OffsetInterval::Echo> exchange;
  if (named != hello.echoes.end() && hello.session_tx) {
    if (!member.is_near) member.echo.echoes_us = true;
    if (const auto sent = p_.greeter.sent_at(kWholeScene, named->hello)) {
      exchange = {*sent, *hello.session_tx - named->hold_time};
    }
  }
  if (member.is_near && !exchange) return;  // its other hellos say more
  p_.time.on_stamps(now, member, hello, exchange);
  keeper_.follow_leader(now, sender);
}

// ---- hellos ----

void Intake::on_hello(HostTime now, PeerId sender, std::uint32_t number, const Hello& hello) {
  Member& member = *p_.members.find(sender);
  if (member.echoes_on != member.channel) {  // its hellos come another way, and count this peer's datagrams anew
    member.echoes_on = member.channel;
    member.echo.acknowledgement.reset();
    member.hello = 0;
  }
  const bool is_newest = number > member.hello;
  if (member.channel == kWholeScene) {
    member.far_hello.receive(number, now);
    member.promises_hellos = false;
  }
  member.hello = number;
  member.hello_rx = now;
  member.awaits_our_decision = std::ranges::any_of(hello.notes, [&](const ContactNote& n) {
    return n.deferred && p_.decisions.may_decide(p_.config.id, p_.owners.of(n.collider), p_.owners.of(n.collidee));
  });
  const bool begins = hello.sessions != member.sessions;  // it knows of no updates yet
  if (begins && p_.limits.take(now, sender, MemberLimit::kResends)) {
    p_.own.resend_all();
    p_.decisions.on_new_session_of(sender);
    if (p_.world_time.zero()) keeper_.reintroduce();
  }
  member.sessions = hello.sessions;
  member.synchronised = hello.session_tx.has_value();
  member.latency = hello.latency;
  if (hello.introduction) on_introduction(now, sender, member, hello);
  const auto named = std::ranges::find(hello.echoes, p_.config.id, &Echo::peer);
  // An echo of more than this peer has sent is of its last incarnation.
  const bool counts = named != hello.echoes.end() && named->received.highest <= p_.outbox.last_number(member.channel);
  const Echo* echo = counts ? &*named : nullptr;
  on_echo(now, sender, member, hello, echo);
  if (hello.session_tx && p_.replica.begun() && p_.time.clock().synchronised()) {
    const SimTime session_now = p_.to_session(now);
    member.delays.add(delay_of(*hello.session_tx, session_now));
    p_.display.on_latency(*hello.session_tx, hello.latency, session_now);
    p_.decisions.on_contact_notes(sender, hello, session_now);
    scene_.on_digest(member, hello);
  }
  const auto zero = hello.introduction && hello.session_tx ? hello.introduction->world_zero : std::nullopt;
  const bool is_another = zero && p_.time.follows() == sender && p_.world_time.zero() && zero != p_.world_time.zero();
  const bool may_count = !is_another || p_.limits.take(now, sender, MemberLimit::kResends);
  if (zero && may_count && p_.world_time.on_zero(sender, p_.time.follows(), *zero)) {
    keeper_.reintroduce();
    p_.scripted.restart();
  }
  if (!is_newest) return;
  std::optional<OffsetInterval::Echo> exchange;
  if (const auto sent = echo != nullptr ? p_.greeter.sent_at(member.channel, echo->hello) : std::nullopt;
      sent && hello.session_tx) {
    exchange = {*sent, *hello.session_tx - echo->hold_time};
  }
  p_.time.on_stamps(now, member, hello, exchange);
  keeper_.follow_leader(now, sender);
}

void Intake::on_introduction(HostTime now, PeerId sender, Member& member, const Hello& hello) {
  const Introduction& introduction = *hello.introduction;
  if (member.name != introduction.name) report_same_name(sender, introduction.name);
  member.name = introduction.name;
  member.start = introduction.start;
  member.viewpoint = introduction.viewpoint;
  // A peer in another session has published nothing yet that this one could take.
  const bool both = hello.session_tx && p_.replica.begun();
  const Duration ahead = both ? *hello.session_tx - p_.to_session(now) : Duration{0};
  if (!hello.session_tx || ahead <= -kUpdateAgeMax || ahead >= kUpdateAheadMax) return;
  if (!may_claim(now, sender, introduction.owned)) return;
  keeper_.claim(sender, introduction.owned, introduction.owned_as_founder, hello.session_tx);
}

bool Intake::may_claim(HostTime now, PeerId sender, std::span<const ObjectId> objects) {
  const auto of_others = std::ranges::count_if(objects, [&](ObjectId object) {
    const PeerId owner = p_.owners.of(object);
    return owner != kNobody && owner != sender;
  });
  return of_others == 0 || p_.limits.take(now, sender, MemberLimit::kClaims, static_cast<double>(of_others));
}

void Intake::report_same_name(PeerId sender, const std::string& name) {
  if (name == p_.config.name) return p_.outbox.push(NameInUse{sender, p_.config.id, name});
  std::optional<PeerId> same;
  p_.members.for_each([&](PeerId peer, const OtherPeer& other) {
    if (!same && peer != sender && other.name == name) same = peer;
  });
  if (same) p_.outbox.push(NameInUse{sender, *same, name});
}

// `echo`: what the sender's hello says of this peer's datagrams; null: nothing.
void Intake::on_echo(HostTime now, PeerId sender, Member& member, const Hello& hello, const Echo* echo) {
  if (echo == nullptr) {
    member.echo.on_hello_without_echo(leaves_out(hello.echoes, p_.config.id), p_.members.hellos_in_a_turn());
    return;
  }
  // The objects that the sender had forgotten stand still there.
  if (member.echo.on_echo(*echo) && p_.limits.take(now, sender, MemberLimit::kResends)) p_.own.resend_all();
  if (member.channel != p_.members.channel()) return;  // it is of what this peer has numbered otherwise
  const Acknowledgement& acknowledgement = *member.echo.acknowledgement;
  for (auto& [object, own] : p_.own) {
    Delivery& delivery = own.delivery;
    if (delivery.acknowledged_by.contains(sender)) continue;
    if (std::ranges::none_of(delivery.sent_in, [&](std::uint32_t n) { return acknowledgement.has(n); })) continue;
    delivery.acknowledged_by.insert(sender);
    delivery.unacknowledged_by.erase(sender);
  }
  p_.decisions.on_acknowledgement(sender, acknowledgement);
}

// ---- records ----

void Intake::drop_of_the_future(HostTime now, PeerId sender, const char* reason) {
  const Member& member = *p_.members.find(sender);
  const auto clock = member.clock.at(now, kDrift_ppm + kSlew_ppm);
  const Duration own = p_.time.clock().session_minus_host(now);
  const bool shares_time = member.synchronised && clock && clock->most < own + kUpdateAheadMax / 2;
  if (!shares_time) ahead_since_.erase(sender);
  if (!shares_time) return p_.drop(sender, reason);
  std::erase_if(ahead_since_, [&](const auto& each) { return now - each.second > kAheadForgotten; });
  const HostTime since = ahead_since_.try_emplace(sender, now).first->second;
  if (member.hello_rx - since <= kLatencyMax) return p_.drop(sender, reason);
  p_.limits.refuse(now, sender, MemberLimit::kStampAhead);
}

void Intake::on_records(HostTime now, PeerId sender, Message& m, SimTime session_now) {
  if (m.unknown_models > 0) p_.counters.drops["unknown_model"] += m.unknown_models;
  const auto subscribed = static_cast<double>(m.subscriptions.size());
  if (subscribed > 0.0 && p_.limits.take(now, sender, MemberLimit::kSubscriptions, subscribed)) {
    p_.regions.on_subscriptions(sender, m.subscriptions, session_now);
  }
  p_.regions.on_handovers(sender, m.handovers, session_now);
  take_early(now, is_tick_due(now) ? p_.reached() : session_now);
  for (UpdateRecord& u : m.updates) {
    if (u.at < session_now - kUpdateAgeMax) {
      p_.drop(sender, "update_time");
    } else if (u.at > session_now + kUpdateAheadMax) {
      drop_of_the_future(now, sender, "update_time");
    } else if (reach(now, u.at)) {
      on_update(sender, m.number, u, session_now);
    } else {
      wait(sender, m.number, u.at, u);
    }
  }
  if (!m.scene.states.empty()) on_scene_states(now, sender, m.number, m.scene, session_now);
  for (const DecisionRecord& d : m.decisions) on_decision(now, sender, m.number, d, session_now);
}

// ---- records of an instant that is still to come ----

bool Intake::is_tick_due(HostTime now) const { return p_.ticks.number_at(p_.to_session(now)) > p_.ticks.last(); }

bool Intake::may_advance() const { return advanced_since_ != p_.ticks.last() || advances_ < kAdvancesMax; }

void Intake::advance(SimTime at) {
  if (std::exchange(advanced_since_, p_.ticks.last()) != p_.ticks.last()) advances_ = 0;
  ++advances_;
  p_.advance_worlds(at);
}

bool Intake::reach(HostTime now, SimTime at) {
  if (at <= p_.reached()) return true;
  if (at > p_.to_session(now) || is_tick_due(now) || !may_advance()) return false;
  advance(at);
  return true;
}

void Intake::wait(PeerId sender, std::uint32_t number, SimTime at, decltype(EarlyRecord::record) record) {
  if (std::exchange(early_life_, p_.replica.lives()) != p_.replica.lives()) early_.clear();
  const std::uint64_t incarnation = p_.members.find(sender)->incarnation;
  if (early_.add({at, sender, incarnation, number, std::move(record)})) {
    ++p_.counters.records_early;
    return;
  }
  p_.members.find(sender)->mark_as_missing(number);
  p_.drop(sender, "too_many_early");
}

void Intake::take_early(HostTime now, SimTime t) {
  if (early_life_ != p_.replica.lives()) return;  // they are of worlds that are no more
  while (auto early = early_.take_until(may_advance() ? t : std::min(t, p_.reached()))) {
    if (early->at > p_.reached()) advance(early->at);
    const Member* const sender = p_.members.find(early->sender);
    if (sender == nullptr || sender->incarnation != early->incarnation) continue;  // it has left meanwhile
    const SimTime session_now = std::max(p_.to_session(now), early->at);
    if (auto* const update = std::get_if<UpdateRecord>(&early->record)) {
      on_update(early->sender, early->number, *update, session_now);
    } else if (const auto* const states = std::get_if<SceneStates>(&early->record)) {
      scene_.on_states(early->sender, *states);
    } else {
      take_decision(now, early->sender, early->number, std::get<DecisionRecord>(early->record), session_now);
    }
  }
}

// A state of longer than a second ahead is refused by the scene.
void Intake::on_scene_states(HostTime now, PeerId sender, std::uint32_t number, SceneStates& scene,
                             SimTime session_now) {
  std::vector<UpdateRecord> reached;
  for (const UpdateRecord& state : scene.states) {
    if (state.at > session_now + kUpdateAheadMax || reach(now, state.at)) {
      reached.push_back(state);
    } else {
      wait(sender, number, state.at, SceneStates{scene.since, {state}});
    }
  }
  scene.states = std::move(reached);
  if (!scene.states.empty()) scene_.on_states(sender, scene);
}

void Intake::on_decision(HostTime now, PeerId sender, std::uint32_t number, const DecisionRecord& d,
                         SimTime session_now) {
  if (d.contact < session_now - kDecisionAgeMax) return p_.drop(sender, "decision_time");
  if (d.contact > session_now + kUpdateAheadMax) return drop_of_the_future(now, sender, "decision_time");
  if (!p_.limits.take(now, sender, MemberLimit::kDecisions)) {
    return p_.members.find(sender)->mark_as_missing(number);
  }
  if (!reach(now, d.contact)) return wait(sender, number, d.contact, d);
  take_decision(now, sender, number, d, session_now);
}

// A decision that is refused for what this peer knows now may be taken when it comes again.
void Intake::take_decision(HostTime now, PeerId sender, std::uint32_t number, const DecisionRecord& d,
                           SimTime session_now) {
  const bool is_pair = p_.model->are_paired(d.collider, d.collidee);
  if (const auto broken = is_pair ? p_.decision_check.broken_by(now, sender, d) : std::nullopt) {
    p_.limits.refuse(now, sender, *broken);
    return p_.members.find(sender)->mark_as_missing(number);
  }
  if (const char* why = p_.decisions.on_decision(sender, number, d, session_now)) p_.drop(sender, why);
}

void Intake::on_update(PeerId sender, std::uint32_t number, UpdateRecord& u, SimTime session_now) {
  const RelaySettings& relay = p_.config.relay;
  const bool relayed = relay.through == sender;
  if (relay.through != kNobody && !relayed && relay.through != p_.config.id) return;  // the relay passes it on
  if (u.carrier && !p_.model->may_carry(*u.carrier, u.object)) return p_.drop(sender, "carrier");
  PeerId owner = p_.owners.of(u.object);
  if (p_.scene.contains(u.object) && u.decision != SimTime{} && !relayed) {
    if (!scene_.take_over(sender, u)) return p_.drop(sender, "not_owner");
    owner = p_.owners.of(u.object);
  } else if (owner == kNobody && !relayed) {  // its hello may have been lost
    keeper_.claim(sender, {&u.object, 1}, 0, u.at);
    owner = p_.owners.of(u.object);
  }
  if (relayed && p_.own.contains(u.object)) {
    p_.display.on_update_age(session_now - u.at);
    return;
  }
  Member* owning = p_.members.find(owner);
  if (owning == nullptr || (owner != sender && !relayed)) {
    // The sender may be its owner's successor, or go on under an owner whose claim has not come yet. Datagrams to
    // regions are not acknowledged.
    if (!p_.regions.cuts()) p_.members.find(sender)->received[kWholeScene].mark_as_missing(number);
    return p_.drop(sender, "not_owner");
  }
  std::uint32_t& last = owning->last_sequence[u.object];
  const bool elsewhere = !p_.replica.receives(u.object) && p_.regions.interest().receives(p_.replica.position_of(u));
  if (u.sequence == last && !elsewhere) {
    ++p_.counters.updates_duplicate;
    return;
  }
  if (u.sequence < last) {
    take_overtaken(u);
    return p_.drop(sender, "old_sequence");
  }
  if (last > 0 && p_.replica.receives(u.object)) p_.display.on_missing(u.sequence - last - 1);
  last = u.sequence;
  p_.display.on_update_age(session_now - u.at);
  ++p_.counters.updates_in;
  if (relay.through == p_.config.id) {
    if (relay.restamps) u.at = session_now;
    p_.publication.relay(u);
    ++p_.counters.updates_relayed;
  }
  if (!p_.regions.accept(u, session_now)) return;
  const SimTime decided = p_.decisions.last_binding(u.object);
  if (!p_.decisions.counts(u, decided)) {
    if (u.at <= decided) take_until_decision(u, session_now);
    return p_.drop(sender, "before_decision");
  }
  p_.display.on_update(u.at, session_now);
  p_.replica.note_update(u);
  if (u.carrier && !p_.model->is_carrier(*u.carrier)) keeper_.let_move(*u.carrier);  // its owner's hello may be lost
  if (!p_.replica.ghosts().has(u.object)) p_.replica.declare_remote(u.object, Role::kPredicted);
  const Base base = p_.replica.base_of(u);
  p_.replica.set_ghost(u.object, base.at, base.model, p_.own.contains(u.object), {}, base.free);
  p_.decisions.on_drive(u);
}

// A later update has come before it. Until the instant of that one the ghost goes by this one, as its owner's does, and
// others may have met it there. The truth stays. Updates to regions may be of a time in which this peer did not receive
// the object.
void Intake::take_overtaken(const UpdateRecord& u) {
  if (p_.regions.cuts() || !p_.replica.ghosts().has(u.object)) return;
  if (!p_.replica.keep_overtaken(u)) return;
  p_.decisions.replay_ghost(u.object, u.at);
  p_.decisions.on_drive(u);
}

// The update does not know of a later decision. From the update to that decision the ghost goes as its owner has shown
// it, unless an earlier decision makes the update void for all: others may have met the ghost then, and with a bounded
// latency that time is still to be shown. From the decision on the object goes as it did, and the truth stays: the
// contact has been found in it.
void Intake::take_until_decision(const UpdateRecord& u, SimTime session_now) {
  const bool counts = p_.decisions.counts(u, p_.decisions.last_binding(u.object, u.at - Duration{1}));
  if (!counts || p_.own.contains(u.object) || !p_.replica.ghosts().has(u.object)) return;
  p_.display.on_update(u.at, session_now);
  p_.replica.keep_update(u);
  p_.decisions.replay_ghost(u.object, u.at);
  p_.decisions.on_drive(u);
}

}  // namespace peerd::replication
