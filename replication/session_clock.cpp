#include "replication/session_clock.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>

namespace peerd::replication {
namespace {

// Slewing by half a percent moves a 10 m/s object's belief by 5 cm/s: below any threshold in use.
constexpr std::int64_t kSlewDivisor = 200;
// Farther than this apart, two sessions have met (a healed partition): slewing would take longer than 50 s.
constexpr Duration kStepBeyond = std::chrono::milliseconds(250);
// Our own stamp comes back within this; an older one, or one from our future, was not sent by us.
constexpr Duration kEchoAgeMax = std::chrono::seconds(10);
// No clock and no offset is farther than this from 0 (146 years); sums of three stay within int64 when each is checked.
constexpr double kTimeMax_ns = 0x1p62;

double ns(Duration d) { return static_cast<double>(d.count()); }

// Stamps are other people's: what they say together must be possible before it is computed.
bool plausible(const SessionClock::Exchange& e) {
  if (e.t1 > e.t4 || e.t4 - e.t1 > kEchoAgeMax) return false;
  const double t2 = ns(e.t2.time_since_epoch()), t3 = ns(e.t3.time_since_epoch()), t4 = ns(e.t4.time_since_epoch());
  return t3 >= t2 && t3 - t2 <= ns(kEchoAgeMax) && std::abs(t3 - t4) < kTimeMax_ns / 2.0;
}

}  // namespace

void SessionClock::found_session() {
  assert(!synchronised_);
  synchronised_ = true;
  offset_ = Duration{0};
}

void SessionClock::on_exchange(const Exchange& e) {
  if (!plausible(e)) return;
  const Duration ahead = e.t2.time_since_epoch() - e.t1.time_since_epoch();
  const Duration behind = e.t3.time_since_epoch() - e.t4.time_since_epoch();
  const Duration round_trip = (e.t4 - e.t1) - (e.t3 - e.t2);
  if (round_trip < Duration{0}) return;  // a clock was set meanwhile
  samples_[sample_count_ % kSamples] = {ahead + (behind - ahead) / 2, round_trip};
  ++sample_count_;
  if (sample_count_ >= kSamplesToStart) error_bound_ = best().round_trip / 2;
  if (!synchronised_ && sample_count_ >= kSamplesToStart) {
    synchronised_ = true;
    offset_ = best().offset;
    adjusted_at_ = e.t4;
  }
}

void SessionClock::follow_another() { sample_count_ = 0; }

bool SessionClock::adjust(HostTime now) {
  const Duration elapsed = now - adjusted_at_;
  adjusted_at_ = now;
  if (!synchronised_ || sample_count_ < kSamplesToStart) return false;
  const Duration wanted = best().offset - offset_;
  if (wanted > kStepBeyond || wanted < -kStepBeyond) {
    offset_ += wanted;
    return true;
  }
  const Duration most = std::max(Duration{0}, elapsed) / kSlewDivisor;
  offset_ += std::clamp(wanted, -most, most);
  return false;
}

const SessionClock::Sample& SessionClock::best() const {
  assert(sample_count_ > 0);
  const auto known = std::span(samples_).first(std::min(sample_count_, kSamples));
  return *std::ranges::min_element(known, {}, &Sample::round_trip);
}

Duration SessionClock::error_bound() const { return error_bound_; }

}  // namespace peerd::replication
