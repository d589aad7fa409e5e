#include "replication/session/session_clock.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::replication {
namespace {

// Slewing by half a percent moves the ghost of a 10 m/s object by 5 cm/s: below any threshold in use. A clock that is
// off by more than kFastBeyond moves it by more anyway: it is slewed ten times as fast.
constexpr std::int64_t kSlewDivisor = 200, kFastSlewDivisor = 1'000'000 / kSlew_ppm;
static_assert(kFastSlewDivisor > 1 && kFastSlewDivisor < kSlewDivisor);
constexpr Duration kFastBeyond = std::chrono::milliseconds(20);
// Farther than this behind, this host was stopped or two sessions have met: slewing would take longer than 5 s.
constexpr Duration kStepBeyond = std::chrono::milliseconds(250);
static_assert(kStepBeyond > kFastBeyond);

}  // namespace

void SessionClock::lead(HostTime now, Duration ahead) {
  assert(ahead >= Duration{0});
  offset_ = has_time_ ? session_minus_host(now) : ahead;
  debt_ = Duration{0};
  adjusted_at_ = now;
  estimate_.reset();
  leads_ = has_time_ = true;
}

void SessionClock::follow(HostTime now, const Estimate& estimate, Duration steady) {
  assert(!estimate.bounds || estimate.bounds->least <= estimate.bounds->most);
  assert(estimate.reference_error >= Duration{0});
  if (std::exchange(leads_, false)) steady_until_ = now + steady;
  if (!estimate.bounds) {
    estimate_.reset();
    return;
  }
  if (!estimate_ && !estimate.settled) return;
  if (!has_time_) {
    offset_ = estimate.likely;
    adjusted_at_ = now;
    has_time_ = true;
  }
  estimate_ = estimate;
}

void SessionClock::stop(HostTime now, Duration gap) {
  assert(gap >= Duration{0});
  offset_ = session_minus_host(now - gap) - gap;
  debt_ = Duration{0};
  adjusted_at_ = now;
  leads_ = false;
  estimate_.reset();
  steady_until_ = HostTime::min();
}

std::optional<Duration> SessionClock::adjust(HostTime now) {
  offset_ = session_minus_host(now);
  adjusted_at_ = now;
  debt_ = Duration{0};
  if (!estimate_) return std::nullopt;
  const Duration wanted = likely(now) - offset_;
  // A likely offset alone is no reason: a latency that falls moves it by half of what it falls by, until a datagram has
  // come back. The bounds of a clock that is behind lie ahead of it.
  const OffsetBounds bounds = estimate_->bounds->aged(now - estimate_->at, estimate_->drift_ppm);
  const bool surely_behind = bounds.least - offset_ > kStepBeyond / 2;
  if (wanted > kStepBeyond && surely_behind && estimate_->settled) {
    offset_ += wanted;
    return wanted;
  }
  if (now < steady_until_) return std::nullopt;
  debt_ = wanted;
  slew_divisor_ = std::chrono::abs(debt_) > kFastBeyond ? kFastSlewDivisor : kSlewDivisor;
  return std::nullopt;
}

Duration SessionClock::session_minus_host(HostTime now) const {
  assert(slew_divisor_ > 0);
  const Duration most = std::max(Duration{0}, now - adjusted_at_) / slew_divisor_;
  return offset_ + std::clamp(debt_, -most, most);
}

SimTime SessionClock::to_session(HostTime host) const {
  return SimTime{host.time_since_epoch() + session_minus_host(host)};
}

HostTime SessionClock::to_host(SimTime session) const {
  const HostTime unslewed{session.time_since_epoch() - offset_};
  if (debt_ == Duration{0} || unslewed <= adjusted_at_) return unslewed;
  // elapsed + elapsed / slew_divisor_ (or minus) is the time until then, as long as the debt is not paid.
  const Duration until = unslewed - adjusted_at_;
  const std::int64_t rate = slew_divisor_ + (debt_ > Duration{0} ? 1 : -1);
  HostTime host = adjusted_at_ + until / rate * slew_divisor_;
  host = debt_ > Duration{0} ? std::max(host, unslewed - debt_) : std::min(host, unslewed - debt_);
  while (to_session(host) < session) host += session - to_session(host);  // adds what integer division has cut off
  while (to_session(host - Duration{1}) >= session) host -= Duration{1};
  assert(to_session(host) >= session);
  return host;
}

std::optional<Duration> SessionClock::error_bound(HostTime now) const {
  if (leads_) return Duration{0};
  if (!estimate_) return std::nullopt;
  assert(estimate_->bounds);
  const OffsetBounds bounds = estimate_->bounds->aged(now - estimate_->at, estimate_->drift_ppm);
  const Duration reference = estimate_->reference_error +
                             drift(now - estimate_->at, estimate_->reference_error > Duration{0} ? kDrift_ppm : 0);
  const Duration offset = session_minus_host(now);
  return std::max(bounds.most - offset, offset - bounds.least) + reference;
}

Duration SessionClock::likely(HostTime now) const {
  assert(estimate_);
  return estimate_->likely + from_seconds(estimate_->speed * to_seconds(now - estimate_->at));
}

}  // namespace peerd::replication
