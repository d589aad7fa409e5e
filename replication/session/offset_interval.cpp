#include "replication/session/offset_interval.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>
#include <utility>

namespace peerd::replication {
namespace {

// A stamp of this peer comes back within this; an older one, or one from the future, is not its own.
constexpr Duration kEchoAgeMax = std::chrono::seconds(10);
// No clock and no offset is farther than this from 0 (73 years): sums of some of them stay within int64.
constexpr double kStampMax_ns = 0x1p61;

double ns(Duration d) { return static_cast<double>(d.count()); }

// Stamps come from other peers: what they say must be possible before it is computed with.
bool plausible(SimTime theirs, HostTime ours) {
  return std::abs(ns(theirs.time_since_epoch()) - ns(ours.time_since_epoch())) < kStampMax_ns;
}
bool plausible(const OffsetInterval::Echo& echo, SimTime t3, HostTime t4) {
  const double held_ns = ns(t3.time_since_epoch()) - ns(echo.t2.time_since_epoch());
  return echo.t1 <= t4 && t4 - echo.t1 <= kEchoAgeMax && held_ns >= 0.0 && held_ns <= ns(kEchoAgeMax);
}

}  // namespace

Duration drift(Duration elapsed, std::int64_t ppm) {
  assert(ppm >= 0);
  constexpr Duration kLongest =
      std::chrono::years(1);  // no peer is silent for so long; the limit keeps the product within int64
  return (std::clamp(elapsed, Duration{0}, kLongest) / 1000 + Duration{1}) * ppm / 1000;
}

std::optional<OffsetBounds> intersection(const OffsetBounds& a, const OffsetBounds& b) {
  const OffsetBounds both{std::max(a.least, b.least), std::min(a.most, b.most)};
  return both.least <= both.most ? std::optional(both) : std::nullopt;
}

bool OffsetInterval::on_hello(SimTime t3, HostTime t4, const std::optional<Echo>& echo, std::int64_t drift_ppm) {
  if (!plausible(t3, t4)) return true;
  const Duration behind = t3.time_since_epoch() - t4.time_since_epoch();
  const Duration least = behind - kStampError;
  bool echoed = echo && plausible(*echo, t3, t4);
  const Duration ahead = echoed ? echo->t2.time_since_epoch() - echo->t1.time_since_epoch() : Duration{0};
  // The upper bound ages from t1 on, so that of two equally quick ways the newer one counts.
  const Duration most = echoed ? ahead + drift(t4 - echo->t1, drift_ppm) + kStampError : Duration::max();
  const Duration older = drift(t4 - at_, drift_ppm);
  if (least_) *least_ -= older;
  if (most_) *most_ += older;
  const bool agrees = least <= most && (!most_ || least <= *most_) && (!least_ || *least_ <= most);
  if (!agrees) {
    *this = {};
    echoed = echoed && least <= most;  // else the clock jumped between the two stamps
  }
  least_ = std::max(least_.value_or(least), least);
  if (echoed) {
    most_ = std::min(most_.value_or(most), most);
    ++exchanges_;
    round_trip_ = ahead - behind;
    from_us_.add({ahead, echo->t1});
  }
  at_ = t4;
  origin_ = behind;
  to_us_.add({behind, t4});
  assert(least_ && (!most_ || *least_ <= *most_));
  return agrees;
}

std::optional<OffsetBounds> OffsetInterval::at(HostTime now, std::int64_t drift_ppm) const {
  if (!least_ || !most_) return std::nullopt;
  return OffsetBounds{*least_, *most_}.aged(now - at_, drift_ppm);
}

double OffsetInterval::by_now_s(const Direction::Sample& sample, HostTime now, double speed) const {
  return to_seconds(sample.offset - origin_) + speed * to_seconds(now - sample.at);
}

// Fits one line to each direction, both of one slope, by least squares; and then again without the datagrams that were
// held back on their way, as delays only ever add. The slope is known beforehand to be of the size kMost (the mode of
// a Gaussian posterior), so that delays that vary are not taken for a speed.
OffsetInterval::Speed OffsetInterval::speed() const {
  constexpr double kMost = 1e-6 * kDrift_ppm;
  // A sample straggles if it is so many times as late as the median of its direction: delays that are spread evenly do
  // not straggle.
  constexpr double kStraggling = 3.0;
  Speed speed{0.0, kMost};
  std::array<std::pair<Direction, double>, 2> ways{
      {{to_us_, 1.0}, {from_us_, -1.0}}};  // sorted below, the quickest first
  for (const bool without_stragglers : {false, true, true}) {
    double n = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
    for (auto& [way, sign] : ways) {
      std::span<Direction::Sample> kept = way.samples();
      if (kept.empty()) continue;
      if (without_stragglers) {
        const auto quickness_s = [&, sign = sign](const Direction::Sample& s) {
          return sign * by_now_s(s, at_, speed.value);
        };
        std::ranges::sort(kept, std::greater{}, quickness_s);
        const double quickest_s = quickness_s(kept.front());
        const double latest_s = quickest_s - kStraggling * (quickest_s - quickness_s(kept[kept.size() / 2]));
        const auto stragglers = std::ranges::upper_bound(kept, latest_s, std::greater{}, quickness_s);
        kept = {kept.begin(), stragglers};
      }
      double mean_x = 0.0, mean_y = 0.0;
      for (const Direction::Sample& s : kept) {
        mean_x += to_seconds(s.at - at_) / static_cast<double>(kept.size());
        mean_y += to_seconds(s.offset - origin_) / static_cast<double>(kept.size());
      }
      for (const Direction::Sample& s : kept) {
        const double x = to_seconds(s.at - at_) - mean_x, y = to_seconds(s.offset - origin_) - mean_y;
        xx += x * x;
        xy += x * y;
        yy += y * y;
      }
      n += static_cast<double>(kept.size());
    }
    if (n < 4.0 || !(xx > 0.0)) break;  // three values are fitted: two means and the slope
    const double variance = std::max(0.0, yy - xy * xy / xx) / (n - 3.0);
    const double weight = xx + variance / (kMost * kMost);
    assert(weight > 0.0);
    speed = {std::clamp(xy / weight, -kMost, kMost), std::sqrt(variance / weight)};
  }
  return speed;
}

OffsetInterval::Likely OffsetInterval::likely(HostTime now) const {
  assert(least_ && most_ && !to_us_.samples().empty() && !from_us_.samples().empty());
  const Speed known = speed();
  // The quickest sample of a direction; the possible error of the speed counts against old samples.
  const auto quickest_s = [&](const Direction& way, double sign) {
    const auto quickness_s = [&](const Direction::Sample& s) {
      return sign * by_now_s(s, now, known.value) - known.error * to_seconds(now - s.at);
    };
    return by_now_s(*std::ranges::max_element(way.samples(), {}, quickness_s), now, known.value);
  };
  // One sample is of its arrival, the other of its departure: the drift of the clocks in between cancels.
  return {origin_ + from_seconds((quickest_s(to_us_, 1.0) + quickest_s(from_us_, -1.0)) / 2.0), known.value};
}

}  // namespace peerd::replication
