#pragma once
#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <numeric>
#include <optional>

#include "core/time.hpp"

namespace peerd::replication {

// The one-way delays of another peer's last hellos, session time to session time.
class DelayMeter {
 public:
  static constexpr std::size_t kDelays = 16;

  void add(Duration delay) {
    assert(delay >= Duration{0});
    delays_[measured_++ % kDelays] = delay;
  }
  // The last delay. At least one has been measured.
  [[nodiscard]] Duration last() const {
    assert(measured_ > 0);
    return delays_[(measured_ - 1) % kDelays];
  }
  // The mean of the delays; none before the first.
  [[nodiscard]] std::optional<Duration> mean() const {
    if (measured_ == 0) return std::nullopt;
    const auto known = static_cast<std::ptrdiff_t>(count());
    return std::accumulate(delays_.begin(), delays_.begin() + known, Duration{0}) / known;
  }
  // The longest of the delays; 0 before the first.
  [[nodiscard]] Duration longest() const {
    return std::accumulate(delays_.begin(), delays_.begin() + static_cast<std::ptrdiff_t>(count()), Duration{0},
                           [](Duration a, Duration b) { return std::max(a, b); });
  }

 private:
  [[nodiscard]] std::size_t count() const { return std::min(measured_, kDelays); }

  std::array<Duration, kDelays> delays_{};
  std::size_t measured_ = 0;  // ever
};

// The latency that a peer publishes, from the longest delay that it has measured: rounded up to a multiple of
// kLatencyStep and at least half of that longer, so that a little jitter does not change the published latency.
[[nodiscard]] Duration latency_bound(Duration longest);

}  // namespace peerd::replication
