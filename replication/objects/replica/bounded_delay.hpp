#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>

#include "core/time.hpp"
#include "replication/settings/policy/bounded_latency.hpp"
#include "replication/wire/codec.hpp"

namespace peerd::replication {

// The bound of BoundedLatency over session time. A measured bound is computed by each peer for itself, from what all of
// them know: the latencies in the hellos, by the session time at which these were sent. What was sent less than
// kKnownAfter ago does not count yet, for not everybody has received it; so peers that have received the same hellos
// have the same bound at every session time, to the nanosecond, with nobody asked.
//
// At a whole second k the bound aims at
//   target(k) = max(least, BoundedLatency::margin() + the longest latency sent in the whole seconds k - 12 to k - 3)
// and between two whole seconds it goes towards it in a straight line, by at most kSlew a second: what is shown then
// goes by a tenth faster or slower, and never jumps.
class BoundedDelay {
 public:
  // No hello is longer under way than any latency that counts.
  static constexpr Duration kKnownAfter = kLatencyMax;
  static constexpr Duration kSlew = std::chrono::milliseconds(100);  // a second

  explicit BoundedDelay(const BoundedLatency& settings) : settings_(settings) {}

  // A peer, which may be this one, has sent at that session time that its latency is so long. `now` is this peer's
  // session time. Stamps of other times than those that can still count, and of the future, are ignored.
  void on_published(SimTime sent, Duration latency, SimTime now);
  // The bound at t, which comes in about the order of time: it may be at most a second before the latest one.
  [[nodiscard]] Duration at(SimTime t);
  // Whether the bound does not change in the second around t, or is as it has been set.
  [[nodiscard]] bool is_steady_at(SimTime t);
  // Session time has stepped.
  void restart();

 private:
  [[nodiscard]] Duration target(std::int64_t second) const;
  void advance_to(std::int64_t second);

  const BoundedLatency& settings_;
  std::map<std::int64_t, Duration> longest_;  // by the whole second of session time in which it was sent
  // The bound at the whole seconds last_ - 2, last_ - 1, .., last_ + 1; none: nobody has asked yet.
  std::array<Duration, 4> bounds_{};
  std::optional<std::int64_t> last_;
};

}  // namespace peerd::replication
