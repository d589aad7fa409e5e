// Peer: whose time the session's is, and what this peer knows of it.
#include <algorithm>
#include <utility>

#include "replication/peer.hpp"

namespace peerd::replication {
namespace {

// Two session times that are surely farther apart are those of two sessions, or one of the hosts was stopped. Slewing
// would take longer than 10 s.
constexpr Duration kOtherSession = std::chrono::milliseconds(500);
// Before this many exchanges a single queued packet could still set the clock.
constexpr std::uint64_t kExchangesToStart = 4;
// So many times as long as it listens anyway, a peer waits for somebody heard to introduce itself, who may have a
// session.
constexpr int kIntroductionPatience = 3;

}  // namespace

// Who hears nobody answers nobody: once it has had the time to, nobody waits for it or follows it.
bool Peer::may_respond(HostTime now, const Member& member) const {
  const auto turn = static_cast<std::int64_t>(hellos_to_name(members_.all().size()));
  const Duration patience = kIntroductionPatience * config_.listen_first + turn * config_.settled_hello_period;
  return member.echoes_us || now - listening_since_ < patience;
}

// True when this peer has founded a session, or goes on with one that nobody else is left of.
bool Peer::found_session(HostTime now) {
  const Duration listened = now - listening_since_;
  if (clock_.synchronised() || listened < config_.listen_first) return false;
  const bool awaits_introduction = unintroduced_peer_at_ && now - *unintroduced_peer_at_ < config_.listen_first;
  if (awaits_introduction && listened < kIntroductionPatience * config_.listen_first) return false;
  for (const auto& [peer, member] : members_.all()) {
    if ((member.synchronised || peer < config_.id) && may_respond(now, member)) return false;
  }
  clock_.lead(now);
  follows_ = config_.id;
  was_suspended_ = false;
  outputs_.push_back(Synchronised{config_.id, clock_.session_minus_host(now), Duration{0}});
  if (!replica_) enter_session(now);
  return true;
}

// Nobody called for long: this host slept, or was stopped, or its clock has jumped. Which of them, and how much time
// has really passed, only the others can tell. So session time goes on from where it was, and this peer says no time
// until it has heard: one that led would else lead everybody into the wrong one. Where nobody is left it founds again.
// True when it is so, and no time of before this call means anything.
bool Peer::detect_suspension(HostTime now) {
  const auto last = std::exchange(called_at_, now);
  if (!last || now - *last <= kSuspendedAfter) return false;
  if (members_.all().empty()) return false;  // nobody to be out of step with: its own clock counts on (keep_session)
  const Duration gap = now - *last;
  members_.restart_silence_of_all(now);  // it was not they who were silent
  members_.forget_clocks();
  follows_.reset();
  listening_since_ = now;
  if (!replica_) return true;
  clock_.stop(now, gap);
  was_suspended_ = true;
  next_hello_ = now;
  settling_until_ = now + kSettling;
  counters_.ticks_missed += static_cast<std::uint64_t>(gap * config_.tick_hz / std::chrono::seconds(1));
  outputs_.push_back(HostSuspended{gap});
  return true;
}

void Peer::on_os_clock(HostTime now, std::optional<OsClock> clock) {
  os_clock_ = clock;
  os_clock_at_ = now;
}

std::optional<OsClockNote> Peer::os_clock_note(HostTime now) const {
  if (!os_clock_) return std::nullopt;
  const Duration error = os_clock_->error + drift(now - os_clock_at_, kDrift_ppm);
  if (error > kOsErrorMax) return std::nullopt;  // as good as none
  return OsClockNote{os_clock_->minus_host - clock_.session_minus_host(now), error};
}

// What a hello says of its sender's time.
void Peer::on_stamps(HostTime now, Member& member, const Hello& hello, const Echo* echo) {
  if (!hello.session_tx) {
    member.clock = {};
    member.leads = false;
    member.os_clock.reset();
    return;
  }
  // Who leads does not slew, nor for a while after its last hello that said so (SessionClock::follow).
  const bool leads = !hello.clock_error;
  const std::int64_t drift_ppm = leads && member.leads ? kDrift_ppm : kDrift_ppm + kSlew_ppm;
  member.leads = leads;
  member.clock_error = hello.clock_error.value_or(Duration{0});
  member.os_clock = hello.os_clock;
  std::optional<OffsetInterval::Echo> stamps;
  if (echo != nullptr) {
    const auto sent = std::ranges::find(sent_hellos_, echo->hello, &SentHello::number);
    if (sent != sent_hellos_.end()) stamps = {sent->at, *hello.session_tx - echo->hold_time};
  }
  if (!member.clock.on_hello(*hello.session_tx, now, stamps, drift_ppm)) ++counters_.clock_contradictions;
  const auto bounds = member.clock.at(now, drift_ppm);
  if (!bounds) {
    member.os_clock.reset();
  } else if (member.os_clock) {  // as of when it left
    const Duration under_way = now + bounds->most - HostTime{hello.session_tx->time_since_epoch()};
    member.os_clock->error += drift(under_way, kDrift_ppm);
  }
}

// By both operating systems' clocks, which no path's asymmetry touches. Of who leads only: session time is then its
// host's and a constant.
std::optional<OffsetBounds> Peer::os_bounds(HostTime now, const Member& member) const {
  if (!os_clock_ || !member.leads || !member.os_clock) return std::nullopt;
  const Duration between = os_clock_->minus_host - member.os_clock->minus_session;
  const Duration error = os_clock_->error + member.os_clock->error + drift(now - os_clock_at_, kDrift_ppm) +
                         drift(now - member.hello_rx, kDrift_ppm);
  return OffsetBounds{between - error, between + error};
}

SessionClock::Estimate Peer::estimate(HostTime now, PeerId peer) {
  Member& member = *members_.find(peer);
  const std::int64_t drift_ppm = member.leads ? kDrift_ppm : kDrift_ppm + kSlew_ppm;
  SessionClock::Estimate e;
  e.bounds = member.clock.at(now, drift_ppm);
  e.at = now;
  e.drift_ppm = drift_ppm;
  e.reference_error = member.clock_error;
  e.settled = member.clock.exchanges() >= kExchangesToStart;
  if (!e.bounds) return e;
  const OffsetInterval::Likely likely = member.clock.likely(now);
  e.likely = std::clamp(likely.offset, e.bounds->least, e.bounds->most);
  e.speed = likely.speed;
  const auto os = os_bounds(now, member);
  if (!os) return e;
  if (const auto both = intersection(*e.bounds, *os)) {
    member.os_clock_doubted = false;
    const bool os_narrower = os->most - os->least < e.bounds->most - e.bounds->least;
    e.bounds = both;
    e.likely = os_narrower ? both->middle() : std::clamp(e.likely, both->least, both->most);
    return e;
  }
  if (!std::exchange(member.os_clock_doubted, true)) {
    ++counters_.os_clocks_doubted;
    outputs_.push_back(OsClockDoubted{peer, std::max(os->least - e.bounds->most, e.bounds->least - os->most)});
  }
  return e;
}

// `own_error`: by how much this peer's own time may be wrong.
Peer::Session Peer::session_of(HostTime now, const Member& member, Duration own_error) const {
  const auto bounds = member.clock.at(now, kDrift_ppm + kSlew_ppm);
  if (!bounds || member.clock.exchanges() < kExchangesToStart) return Session::kUnknown;
  const Duration apart = own_error + member.clock_error + kOtherSession;
  const Duration own = clock_.session_minus_host(now);
  if (bounds->least - own > apart) return Session::kLater;
  if (bounds->most - own < -apart) return Session::kEarlier;
  return Session::kSame;
}

// The lowest peer of the session leads it. Where two sessions have met, the one whose time is later goes on, and the
// other's peers step forward into it: so nobody's time ever runs back. Who has no time yet takes the lowest's.
std::optional<PeerId> Peer::choose_leader(HostTime now) const {
  if (!clock_.synchronised()) {
    const auto lowest = std::ranges::find_if(
        members_.all(), [&](const auto& m) { return m.second.synchronised && may_respond(now, m.second); });
    return lowest == members_.all().end() ? std::nullopt : std::optional(lowest->first);
  }
  // Who has still to step forward into the session leads nobody, and knows nothing of the others' times.
  const bool behind = follows_ && clock_.debt(now) > kOtherSession;
  if (behind && members_.all().contains(*follows_)) return follows_;
  // What is known of the followed peer says all; of the others, how far they and this one are from the leader too. Who
  // is surely ahead of the followed one does not doubt its own time: what it would have to slew back is no error of it.
  const auto followed = follows_ ? members_.all().find(*follows_) : members_.all().end();
  const bool ahead =
      followed != members_.all().end() && session_of(now, followed->second, Duration{0}) == Session::kEarlier;
  const Duration own_error = ahead ? Duration{0} : *clock_.error_bound(now);
  std::optional<PeerId> later;
  PeerId lowest = config_.id;
  for (const auto& [peer, member] : members_.all()) {  // ascending
    if (!member.synchronised) continue;
    const Session session = session_of(now, member, peer == follows_ ? Duration{0} : own_error);
    if (session == Session::kLater && !later) later = peer;
    // One that is followed stays so while nothing surely speaks against it.
    if (session == Session::kSame || (session == Session::kUnknown && peer == follows_))
      lowest = std::min(lowest, peer);
  }
  return later ? later : lowest;
}

// `heard`: whose hello has just come.
void Peer::follow_leader(HostTime now, std::optional<PeerId> sender) {
  const auto leader = choose_leader(now);
  const bool new_leader = std::exchange(follows_, leader) != leader;
  if (leader == config_.id) {
    if (clock_.error_bound(now) != Duration{0}) clock_.lead(now);
    return;
  }
  if (!leader || (!new_leader && leader != sender)) return;  // nothing new of its clock
  clock_.follow(now, estimate(now, *leader), config_.lost_after + longest_latency());
  if (!clock_.synchronised() || replica_) return;
  outputs_.push_back(Synchronised{*leader, clock_.session_minus_host(now), *clock_.error_bound(now)});
  enter_session(now);
}

}  // namespace peerd::replication
