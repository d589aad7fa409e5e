#include "replication/objects/replica/bounded_delay.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::replication {
namespace {

constexpr Duration kSecond = std::chrono::seconds(1);
// The first and the last of the seconds that count towards a target, counted back from it.
constexpr std::int64_t kFirst = 12, kLast = 3;
static_assert(kLast * kSecond >= BoundedDelay::kKnownAfter + kSecond, "a second has to be over and known to all");
// Nobody has asked for so long [s]: the bound begins anew.
constexpr std::int64_t kForgotten = 30;

std::int64_t second_of(SimTime t) { return floor_to(t, kSecond).time_since_epoch() / kSecond; }

}  // namespace

void BoundedDelay::on_published(SimTime sent, Duration latency, SimTime now) {
  if (!settings_.measured) return;
  assert(latency >= Duration{0});
  const std::int64_t second = second_of(sent), current = second_of(now);
  if (second < current - kFirst || second > current + 1) return;
  Duration& longest = longest_[second];
  longest = std::max(longest, latency);
  longest_.erase(longest_.begin(), longest_.lower_bound(current - kFirst - 2));
}

// The target, where no second counts that could, is the bound that there is; at first, what has been sent at all.
Duration BoundedDelay::target(std::int64_t second) const {
  std::optional<Duration> longest;
  const auto take = [&](auto from, auto to) {
    for (; from != to; ++from) longest = std::max(longest.value_or(Duration{0}), from->second);
  };
  take(longest_.lower_bound(second - kFirst), longest_.upper_bound(second - kLast));
  if (!longest && last_) return bounds_.back();
  if (!longest) take(longest_.begin(), longest_.end());
  assert(!longest || *longest >= Duration{0});
  const Duration wanted = longest.value_or(kLatencyStep) + settings_.margin();  // a peer publishes no less than a step
  return std::clamp(wanted, settings_.least, std::max(settings_.least, kBoundMax));
}

void BoundedDelay::advance_to(std::int64_t second) {
  if (last_ && second - *last_ > kForgotten) last_.reset();
  assert(settings_.measured);
  if (!last_) {
    bounds_.fill(target(second));
    last_ = second;
    return;
  }
  for (; *last_ < second; ++*last_) {
    const Duration from = bounds_.back();
    std::ranges::rotate(bounds_, bounds_.begin() + 1);
    bounds_.back() = from + std::clamp<Duration>(target(*last_ + 1) - from, -kSlew, kSlew);
  }
}

Duration BoundedDelay::at(SimTime t) {
  if (!settings_.measured) return settings_.least;
  const std::int64_t second = second_of(t);
  advance_to(second);
  const std::int64_t index = second - (*last_ - 2);
  if (index < 0) return bounds_.front();
  assert(index <= 2);
  const Duration from = bounds_[static_cast<std::size_t>(index)], to = bounds_[static_cast<std::size_t>(index) + 1];
  const Duration since = t - floor_to(t, kSecond);
  return from + Duration{(to - from).count() * since.count() / kSecond.count()};  // at most 1e8 * 1e9
}

bool BoundedDelay::is_steady_at(SimTime t) {
  if (!settings_.measured) return true;
  advance_to(second_of(t));
  assert(last_);
  return bounds_[2] == bounds_[3];
}

void BoundedDelay::restart() {
  longest_.clear();
  last_.reset();
}

}  // namespace peerd::replication
