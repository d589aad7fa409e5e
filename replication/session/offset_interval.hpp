#pragma once
#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/time.hpp"

namespace peerd::replication {

// The most by which two hosts' clocks may differ in speed, in millionths of the slower one's: 500 each, the most by
// which Linux slews a clock (MAXFREQ of adjtimex), and 1.0005 / 0.9995 is 1001 above 1.
inline constexpr std::int64_t kDrift_ppm = 1001;
// The fastest slewing of session time, in millionths (SessionClock).
inline constexpr std::int64_t kSlew_ppm = 50'000;

// The most by which a measured interval of `elapsed` can be off; rounded up.
[[nodiscard]] Duration drift(Duration elapsed, std::int64_t ppm);

// Bounds of another clock minus this host's: the difference is surely within both.
struct OffsetBounds {
  Duration least, most;
  [[nodiscard]] Duration middle() const {
    assert(least <= most);
    return least + (most - least) / 2;
  }
  [[nodiscard]] OffsetBounds aged(Duration elapsed, std::int64_t ppm) const {
    return {least - drift(elapsed, ppm), most + drift(elapsed, ppm)};
  }
};
// The interval in which both hold (Marzullo and Owicki, "Maintaining the time in a distributed system", 1983); none:
// one of them is wrong.
[[nodiscard]] std::optional<OffsetBounds> intersection(const OffsetBounds& a, const OffsetBounds& b);

// The offset of one other peer's session time from this host's clock, by NTP's four stamps (RFC 5905, section 8).
//
// A hello that left at t3 on the other clock and arrived at t4 on this one shows that the other clock is at least t3 -
// t4 ahead, however long the hello took. If the other peer received this peer's hello of t1 at t2, its clock was at
// most t2 - t1 ahead. All stamps hold together, and less surely with time, as clocks drift. So the quickest datagram
// of each direction counts, not the quickest round trip: with jitter the middle is nearer to the truth than that of
// any exchange, and the ends bound its error, whatever the asymmetry of the paths.
class OffsetInterval {
 public:
  // This peer's hello left at t1 on this clock, and arrived at t2 on the other.
  struct Echo {
    HostTime t1;
    SimTime t2;
  };
  // Two stamps of the kernel that are turned into a host's time (peerd/net/os/arrival_clock.hpp) may each be early by
  // so much. A late stamp makes the interval wider, and not wrong.
  static constexpr Duration kStampError = std::chrono::microseconds(2);

  // A hello left at t3 on the other clock and arrived at t4 on this one. `drift_ppm`: the most by which the two clocks
  // have drifted apart since the last hello. False: the stamps cannot be true together with the earlier ones, so a
  // clock has jumped; everything older is forgotten.
  bool on_hello(SimTime t3, HostTime t4, const std::optional<Echo>& echo, std::int64_t drift_ppm);
  // The bounds at `now`; none before both are known.
  [[nodiscard]] std::optional<OffsetBounds> at(HostTime now, std::int64_t drift_ppm) const;
  // The likely offset within the bounds, if both ways take the same time at best and the clocks go on as they do; and
  // how much faster the other clock runs, within +-kDrift_ppm, by the last hellos of both directions.
  struct Likely {
    Duration offset;
    double speed;
  };
  // The likely offset at `now`. Both bounds are known.
  [[nodiscard]] Likely likely(HostTime now) const;
  // The number of echoes that the interval rests on.
  [[nodiscard]] std::uint64_t exchanges() const { return exchanges_; }
  // The round trip of the last echo, without the time for which the other peer held it.
  [[nodiscard]] std::optional<Duration> round_trip() const { return round_trip_; }

 private:
  // The offsets by one direction's last datagrams: each is wrong by its delay.
  class Direction {
   public:
    struct Sample {
      Duration offset;
      HostTime at;
    };
    void add(const Sample& sample) { samples_[added_++ % samples_.size()] = sample; }
    [[nodiscard]] std::span<const Sample> samples() const {
      return std::span(samples_).first(std::min(added_, samples_.size()));
    }
    [[nodiscard]] std::span<Sample> samples() { return std::span(samples_).first(std::min(added_, samples_.size())); }

   private:
    std::array<Sample, 64> samples_{};  // a minute of settled hellos
    std::size_t added_ = 0;
  };
  struct Speed {
    double value = 0.0, error = 0.0;
  };
  [[nodiscard]] Speed speed() const;
  // The offset of a sample from origin_ [s], extrapolated to `now` at that speed.
  [[nodiscard]] double by_now_s(const Direction::Sample& sample, HostTime now, double speed) const;

  std::optional<Duration> least_, most_;
  HostTime at_{};  // the time at which the two bounds held
  std::uint64_t exchanges_ = 0;
  std::optional<Duration> round_trip_;
  Direction to_us_, from_us_;
  Duration origin_{0};  // offsets are computed from here: a double holds no nanosecond since 1970
};

}  // namespace peerd::replication
