#include "replication/session/session_time.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "replication/wire/codec.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::replication {
namespace {

// Two session times that are surely farther apart are those of two sessions, or one of the hosts was stopped. Slewing
// would take longer than 10 s.
constexpr Duration kOtherSession = std::chrono::milliseconds(500);
// A leader of a large session echoes the far hellos of all: one that has echoed nobody's for so long receives nothing.
constexpr Duration kDeafAfter = std::chrono::seconds(5);
// Before this many exchanges a single queued packet could still set the clock.
constexpr std::uint64_t kExchangesToStart = 4;
// A peer waits so many times as long as it listens anyway for a received peer to introduce itself, which may have a
// session.
constexpr int kIntroductionPatience = 3;

// A clock goes back by less: a stamp that is farther ahead is of a clock that was wrong when it was made.
constexpr Duration kBehindMax = std::chrono::hours(24 * 366);

// How far ahead of its host a session begins that this peer founds: behind the stamps of the edits that it has.
Duration first_ahead(HostTime now, SimTime last_stamp) {
  const SimTime by_host{now.time_since_epoch()};
  const bool is_ahead = last_stamp >= by_host && last_stamp < by_host + kBehindMax;
  return is_ahead ? last_stamp - by_host + Duration{1} : Duration{0};
}

// How far ahead a member follows others for sure, by what can be known of it. Other sessions may have used up a quarter
// of the bound (ClockReach). One peer alone, whose operating system does not know how right its clock is, follows
// farther, a minute after its last company at the latest.
Duration follows_ahead(const Member& member, bool is_alone, Duration ahead_max) {
  const Duration left = std::min<Duration>(ahead_max - ahead_max / 4, ClockReach::kFreeAhead / 2);
  if (!member.os_clock) return is_alone ? ClockReach::kFreeAhead / 2 : left;
  return std::clamp(member.os_clock->minus_session, Duration{0}, ClockReach::kFreeAhead / 2) + left;
}

// Whether the member's session has not come to the time of the edits that a newcomer has, though the newcomer's clock
// has: the clock of that session's founder is behind. In it those edits would wait for their time, and new ones of the
// newcomer, whose stamps follow them, too. So it founds a session of its own, and the member's comes forward to it.
// Nobody comes forward in a large session, whose leader may not be near.
bool is_behind_edits(HostTime now, const Membership& members, const Member& member, SimTime last_stamp,
                     Duration ahead_max) {
  const auto bounds = member.clock.at(now, kDrift_ppm + kSlew_ppm);
  if (last_stamp == SimTime::min() || !member.synchronised || !bounds || !members.far().empty()) return false;
  const Duration stamps = last_stamp - SimTime{now.time_since_epoch()};
  if (stamps > kStampAheadMax || bounds->most >= stamps - kStampAheadMax) return false;
  const auto in_session =
      std::ranges::count_if(members.all(), [](const auto& each) { return each.second.synchronised; });
  return bounds->least >= first_ahead(now, last_stamp) - follows_ahead(member, in_session == 1, ahead_max);
}

}  // namespace

SessionTime::SessionTime(const PeerConfig& config, Membership& members, Outbox& outbox, PeerCounters& counters,
                         MemberLimits& limits)
    : config_(config),
      members_(members),
      outbox_(outbox),
      counters_(counters),
      limits_(limits),
      reach_(config.clock_ahead_max) {}

bool SessionTime::start(HostTime now) {
  if (started_) return false;
  started_ = listening_since_ = now;
  return true;
}

// A peer that receives nobody answers nobody: once it has had the time to, nobody waits for it or follows it.
bool SessionTime::may_respond(HostTime now, const Member& member) const {
  const auto turn = static_cast<std::int64_t>(members_.hellos_in_a_turn());
  const Duration patience = kIntroductionPatience * config_.listen_first + turn * config_.settled_hello_period;
  return member.echo.echoes_us || now - listening_since_ < patience;
}

bool SessionTime::found_session(HostTime now) {
  const Duration listened = now - listening_since_;
  if (clock_.synchronised() || listened < config_.listen_first) return false;
  const bool awaits_introduction = unintroduced_peer_at_ && now - *unintroduced_peer_at_ < config_.listen_first;
  if (awaits_introduction && listened < kIntroductionPatience * config_.listen_first) return false;
  const OffsetBounds reach = reach_.at(now, os_minus_host(now));
  // A large session is here. Its leader may take long to answer while many peers join.
  if (std::ranges::any_of(members_.far(), [](const auto& each) { return each.second.synchronised; })) return false;
  for (const auto& [peer, member] : members_.all()) {
    const bool leads = member.synchronised ? is_within(now, member, reach) : peer < config_.id;
    if (!leads || !may_respond(now, member)) continue;
    const bool is_newcomer = !reach_.has_entered();
    if (is_newcomer && is_behind_edits(now, members_, member, behind_, config_.clock_ahead_max)) continue;
    return false;
  }
  clock_.lead(now, first_ahead(now, behind_));
  if (!reach_.has_entered()) reach_.enter(now, clock_.session_minus_host(now));
  follows_ = config_.id;
  was_suspended_ = false;
  outbox_.push(Synchronised{config_.id, clock_.session_minus_host(now), Duration{0}});
  return true;
}

std::optional<Duration> SessionTime::check_suspension(HostTime now, bool in_session) {
  const auto last = std::exchange(called_at_, now);
  assert(!last || now >= *last);
  if (!last || now - *last <= kSuspendedAfter) return std::nullopt;
  if (members_.all().empty()) return std::nullopt;  // its own clock counts on
  const Duration gap = now - *last;
  members_.restart_silence_of_all(now);  // this host was silent, not the members
  members_.forget_clocks();
  follows_.reset();
  listening_since_ = now;
  if (in_session) {
    clock_.stop(now, gap);
    reach_.on_gap(gap);
    was_suspended_ = true;
  }
  return gap;
}

std::optional<SessionTime::Step> SessionTime::adjust(HostTime now) {
  if (const auto step = clock_.adjust(now)) {
    assert(*step > Duration{0});
    return Step{*step, std::exchange(was_suspended_, false)};
  }
  if (clock_.synchronised()) was_suspended_ = false;
  return std::nullopt;
}

void SessionTime::on_os_clock(HostTime now, std::optional<OsClock> clock) {
  assert(!clock || clock->error >= Duration{0});
  os_clock_ = clock;
  os_clock_at_ = now;
}

std::optional<OsClockNote> SessionTime::os_clock_note(HostTime now) const {
  if (!os_clock_) return std::nullopt;
  const Duration error = os_clock_->error + drift(now - os_clock_at_, kDrift_ppm);
  if (error > kOsErrorMax) return std::nullopt;  // no better than none
  return OsClockNote{os_clock_->minus_host - clock_.session_minus_host(now), error};
}

void SessionTime::stamp(Hello& hello, HostTime now) const {
  const auto error = clock_.error_bound(now);
  if (!error || *error > kClockErrorMax) return;
  hello.session_tx = clock_.to_session(now);
  if (follows_ != config_.id) hello.clock_error = *error;
  hello.os_clock = os_clock_note(now);
}

void SessionTime::on_stamps(HostTime now, Member& member, const Hello& hello,
                            const std::optional<OffsetInterval::Echo>& exchange) {
  if (!hello.session_tx) {
    member.clock = {};
    member.leads = false;
    member.os_clock.reset();
    return;
  }
  // A leader does not slew, nor for a while after its last hello that said so (SessionClock::follow).
  const bool leads = !hello.clock_error;
  const std::int64_t drift_ppm = leads && member.leads ? kDrift_ppm : kDrift_ppm + kSlew_ppm;
  member.leads = leads;
  member.clock_error = hello.clock_error.value_or(Duration{0});
  member.os_clock = hello.os_clock;
  if (!member.clock.on_hello(*hello.session_tx, now, exchange, drift_ppm)) ++counters_.clock_contradictions;
  const auto bounds = member.clock.at(now, drift_ppm);
  if (!bounds) {
    member.os_clock.reset();
  } else if (member.os_clock) {  // the error counts from when the hello left
    const Duration under_way = now + bounds->most - HostTime{hello.session_tx->time_since_epoch()};
    member.os_clock->error += drift(under_way, kDrift_ppm);
  }
}

// The bounds by both operating systems' clocks, which no path's asymmetry touches. Of a leader only: session time is
// then its host's and a constant.
std::optional<OffsetBounds> SessionTime::os_bounds(HostTime now, const Member& member) const {
  if (!os_clock_ || !member.leads || !member.os_clock) return std::nullopt;
  const Duration between = os_clock_->minus_host - member.os_clock->minus_session;
  const Duration error = os_clock_->error + member.os_clock->error + drift(now - os_clock_at_, kDrift_ppm) +
                         drift(now - member.hello_rx, kDrift_ppm);
  return OffsetBounds{between - error, between + error};
}

// Whatever the member says, session time is not moved beyond this peer's reach.
SessionClock::Estimate SessionTime::estimate(HostTime now, PeerId peer) {
  SessionClock::Estimate e = estimate_by_stamps(now, peer);
  const OffsetBounds reach = reach_.at(now, os_minus_host(now));
  if (e.bounds) e.likely = std::clamp(e.likely, reach.least, reach.most);
  return e;
}

SessionClock::Estimate SessionTime::estimate_by_stamps(HostTime now, PeerId peer) {
  Member* const found = members_.find(peer);
  assert(found != nullptr);
  Member& member = *found;
  const std::int64_t drift_ppm = member.leads ? kDrift_ppm : kDrift_ppm + kSlew_ppm;
  SessionClock::Estimate e;
  e.bounds = member.clock.at(now, drift_ppm);
  e.at = now;
  e.drift_ppm = drift_ppm;
  e.reference_error = member.clock_error;
  e.settled = member.clock.exchanges() >= kExchangesToStart;
  if (!e.bounds) return e;
  assert(e.bounds->least <= e.bounds->most);
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
    outbox_.push(OsClockDoubted{peer, std::max(os->least - e.bounds->most, e.bounds->least - os->most)});
  }
  return e;
}

// `own_error`: the most by which this peer's own time may be wrong.
SessionTime::Session SessionTime::session_of(HostTime now, const Member& member, Duration own_error) const {
  assert(own_error >= Duration{0});
  const auto bounds = member.clock.at(now, kDrift_ppm + kSlew_ppm);
  if (!bounds || member.clock.exchanges() < kExchangesToStart) return Session::kUnknown;
  const Duration apart = own_error + member.clock_error + kOtherSession;
  const Duration own = clock_.session_minus_host(now);
  if (bounds->least - own > apart) return Session::kLater;
  if (bounds->most - own < -apart) return Session::kEarlier;
  return Session::kSame;
}

std::optional<Duration> SessionTime::os_minus_host(HostTime now) const {
  const bool is_known = os_clock_ && os_clock_->error + drift(now - os_clock_at_, kDrift_ppm) <= kOsErrorMax;
  return is_known ? std::optional(os_clock_->minus_host) : std::nullopt;
}

OffsetBounds SessionTime::reach(HostTime now) const {
  const OffsetBounds reach = reach_.at(now, os_minus_host(now));
  const Duration own = clock_.session_minus_host(now);
  return {reach.least - own, reach.most - own};
}

bool SessionTime::is_within(HostTime now, const Member& member, const OffsetBounds& reach) const {
  if (member.clock_error > config_.clock_ahead_max) return false;
  const auto bounds = member.clock.at(now, kDrift_ppm + kSlew_ppm);
  return !bounds || (bounds->least <= reach.most && bounds->most >= reach.least);
}

// A peer without session time takes that of the lowest peer that has one, of a session that is not far ahead if there
// is one.
std::optional<PeerId> SessionTime::choose_first_leader(HostTime now) const {
  for (const OffsetBounds& reach : {reach_.preferred(now, os_minus_host(now)), reach_.at(now, os_minus_host(now))}) {
    for (const auto& [peer, member] : members_.all()) {  // ascending
      if (!member.synchronised || !is_within(now, member, reach) || !may_respond(now, member)) continue;
      const bool is_newcomer = !reach_.has_entered();
      if (is_newcomer && is_behind_edits(now, members_, member, behind_, config_.clock_ahead_max)) continue;
      return peer;
    }
  }
  return std::nullopt;
}

std::optional<PeerId> SessionTime::choose_leader(HostTime now) {
  if (!clock_.synchronised()) return choose_first_leader(now);
  const OffsetBounds reach = reach_.at(now, os_minus_host(now));
  // A peer that has still to step forward into the session leads nobody, and knows nothing of the others' times.
  const auto followed = follows_ ? members_.all().find(*follows_) : members_.all().end();
  const bool is_followed_here = followed != members_.all().end() && is_within(now, followed->second, reach);
  if (is_followed_here && clock_.debt(now) > kOtherSession) return follows_;
  // The estimate of the followed peer counts fully; for other peers, the distances of them and of this peer from the
  // leader count too. A peer that is surely ahead of the followed one does not doubt its own time: what it would have
  // to slew back is no error of it.
  const bool ahead =
      followed != members_.all().end() && session_of(now, followed->second, Duration{0}) == Session::kEarlier;
  const Duration own_error = ahead ? Duration{0} : *clock_.error_bound(now);
  std::optional<std::pair<PeerId, Duration>> later;  // of the nearest session, and how far ahead of the host
  PeerId lowest = config_.id;
  for (const auto& [peer, member] : members_.all()) {  // ascending
    if (!member.synchronised) continue;
    const Session session = session_of(now, member, peer == follows_ ? Duration{0} : own_error);
    if (session == Session::kSame) reach_.on_company(now);
    if (!is_within(now, member, reach)) continue;
    if (session == Session::kLater) {
      const Duration least = member.clock.at(now, kDrift_ppm + kSlew_ppm)->least;
      if (!later || least < later->second - kOtherSession) later = {peer, least};
    }
    // A followed peer stays followed while nothing surely speaks against it, and its time is known at all.
    const bool stays = session == Session::kUnknown && peer == follows_ && member.clock.at(now, kDrift_ppm);
    if (session == Session::kSame || stays) lowest = std::min(lowest, peer);
  }
  if (later) return later->first;
  const bool would_begin = lowest == config_.id && follows_ != config_.id && members_.is_large();
  return would_begin && awaits_lower_leader(now, own_error) ? std::nullopt : std::optional(lowest);
}

// In a large session the clock of a lower peer that leads, or is to lead, may not be known well enough yet, or the peer
// may be gone. Nobody else begins to lead meanwhile: session time goes on as it is.
bool SessionTime::awaits_lower_leader(HostTime now, Duration own_error) const {
  const OffsetBounds reach = reach_.at(now, os_minus_host(now));
  for (const auto& [peer, member] : members_.all()) {  // ascending
    if (peer >= config_.id) break;
    if (!member.synchronised || !is_within(now, member, reach)) continue;
    if (session_of(now, member, own_error) == Session::kEarlier) continue;  // it follows this one
    const bool is_deaf = member.leads ? now - member.echoing >= kDeafAfter : member.is_near && member.echo.unreachable;
    if (!is_deaf) return true;
  }
  const auto& far = members_.far();
  return std::any_of(far.begin(), far.lower_bound(config_.id),
                     [](const auto& each) { return each.second.synchronised; });
}

// A peer that it would follow if its time were not so far away; one whose time is merely earlier follows this one.
void SessionTime::name_if_too_far_ahead(HostTime now, PeerId sender) {
  const auto member = members_.all().find(sender);
  if (member == members_.all().end() || !member->second.synchronised) return;
  if (is_within(now, member->second, reach_.at(now, os_minus_host(now)))) return;
  const Session session = clock_.synchronised() ? session_of(now, member->second, Duration{0}) : Session::kLater;
  if (session == Session::kLater || session == Session::kSame) limits_.refuse(now, sender, MemberLimit::kClockAhead);
}

bool SessionTime::has_lost_leader() const {
  return follows_ && *follows_ != config_.id && !members_.contains(*follows_);
}

bool SessionTime::follow_leader(HostTime now, std::optional<PeerId> sender, bool in_session) {
  if (sender) name_if_too_far_ahead(now, *sender);
  const auto leader = choose_leader(now);
  const bool new_leader = std::exchange(follows_, leader) != leader;
  if (leader == config_.id) {
    if (clock_.error_bound(now) != Duration{0}) clock_.lead(now);
    return false;
  }
  if (!leader || (!new_leader && leader != sender)) return false;  // nothing new of its clock
  const SessionClock::Estimate leaders = estimate(now, *leader);
  clock_.follow(now, leaders, config_.lost_after + members_.longest_latency());
  if (clock_.synchronised() && leaders.bounds && leaders.settled) {
    const OffsetBounds own = reach_.preferred(now, os_minus_host(now));
    const bool is_far = leaders.likely < own.least || leaders.likely > own.most;
    if (is_far || !reach_.has_entered()) reach_.enter(now, leaders.likely);
  }
  if (!clock_.synchronised() || in_session) return false;
  outbox_.push(Synchronised{*leader, clock_.session_minus_host(now), *clock_.error_bound(now)});
  return true;
}

}  // namespace peerd::replication
