#include "replication/session/clock_reach.hpp"

#include <algorithm>
#include <cassert>
#include <cstdint>

namespace peerd::replication {
namespace {

// Far beyond all offsets, and so that sums of some of them stay within int64.
constexpr Duration kAnyOffset{std::int64_t{1} << 62};

// The later one of this computer's clocks, minus the host's.
Duration by_own_clocks(std::optional<Duration> os_minus_host) {
  return std::max(Duration{0}, os_minus_host.value_or(Duration{0}));
}

}  // namespace

ClockReach::ClockReach(Duration ahead_max) : ahead_max_(ahead_max) { assert(ahead_max > Duration{0}); }

void ClockReach::enter(HostTime now, Duration session_minus_host) {
  home_ = {{session_minus_host, session_minus_host}, now};
}

void ClockReach::on_gap(Duration gap) {
  assert(gap >= Duration{0});
  if (home_) home_->offsets.least -= gap;
}

OffsetBounds ClockReach::preferred(HostTime now, std::optional<Duration> os_minus_host) const {
  if (!home_) return {-kAnyOffset, by_own_clocks(os_minus_host) + ahead_max_};
  // The host's clock by itself does not count here: peers of one session would differ in how far they go.
  const OffsetBounds home = home_->offsets.aged(now - home_->at, kDrift_ppm);
  return {home.least - ahead_max_, std::max(home.most, os_minus_host.value_or(home.most)) + ahead_max_};
}

OffsetBounds ClockReach::at(HostTime now, std::optional<Duration> os_minus_host) const {
  OffsetBounds bounds = preferred(now, os_minus_host);
  if (!is_free(now, os_minus_host.has_value())) return bounds;
  const Duration own = by_own_clocks(os_minus_host);
  const bool is_wrong = now.time_since_epoch() + own < kClockSurelyWrongBefore;
  bounds.most = is_wrong ? kAnyOffset : std::max(bounds.most, own + kFreeAhead);
  return bounds;
}

bool ClockReach::is_free(HostTime now, bool knows_os_clock) const {
  if (!home_) return true;
  return !knows_os_clock && (!company_at_ || now - *company_at_ > kCompanyLasts);
}

}  // namespace peerd::replication
