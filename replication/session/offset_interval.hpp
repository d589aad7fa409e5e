#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/time.hpp"

namespace peerd::replication {

// By how much two hosts' clocks may differ in speed, in millionths of the slower one's: 500 each, the most by which
// Linux slews one (MAXFREQ of adjtimex), and 1.0005 / 0.9995 is 1001 above 1.
inline constexpr std::int64_t kDrift_ppm = 1001;
// How fast session time is slewed at most (SessionClock).
inline constexpr std::int64_t kSlew_ppm = 50'000;

// What an interval of time can be off by after `elapsed`; rounded up.
[[nodiscard]] Duration drift(Duration elapsed, std::int64_t ppm);

// Another clock minus this host's, surely within both.
struct OffsetBounds {
  Duration least, most;
  [[nodiscard]] Duration middle() const { return least + (most - least) / 2; }
  [[nodiscard]] OffsetBounds aged(Duration elapsed, std::int64_t ppm) const {
    return {least - drift(elapsed, ppm), most + drift(elapsed, ppm)};
  }
};
// Where both hold (Marzullo and Owicki, "Maintaining the time in a distributed system", 1983); none: one is wrong.
[[nodiscard]] std::optional<OffsetBounds> intersection(const OffsetBounds& a, const OffsetBounds& b);

// What NTP's four stamps (RFC 5905, section 8) say of the offset of one other peer's session time.
//
// A hello that left at their t3 and came at our t4 says that they are at least t3 - t4 ahead, however long it took;
// that they got ours of t1 at t2, that they were at most t2 - t1 ahead. All that was heard holds together, and less
// surely with time, as clocks drift. So the quickest datagram of each direction counts, not the quickest round trip:
// with jitter the middle is nearer to the truth than any exchange's, and the ends bound its error, whatever the paths'
// asymmetry.
class OffsetInterval {
 public:
  // Our hello left at t1 on our clock, and they got it at t2 on theirs.
  struct Echo {
    HostTime t1;
    SimTime t2;
  };
  // Two stamps of the kernel that are turned into a host's time (peerd/os/arrival_clock.hpp) may each be early by so
  // much. One that is late makes the interval wider, and no wrong.
  static constexpr Duration kStampError = std::chrono::microseconds(2);

  // Their hello left at t3 on their clock and came at t4 on ours. `drift_ppm`: what the two have drifted by at most
  // since the last one. False: that cannot be true together with what was heard before, so a clock has jumped;
  // everything older is forgotten.
  bool on_hello(SimTime t3, HostTime t4, const std::optional<Echo>& echo, std::int64_t drift_ppm);
  // None before both bounds are known.
  [[nodiscard]] std::optional<OffsetBounds> at(HostTime now, std::int64_t drift_ppm) const;
  // .. and where in them it is, if both ways take the same time at best and the clocks go on as they do; and how much
  // faster theirs runs than ours, within +-kDrift_ppm, as the last hellos of both directions show it.
  struct Likely {
    Duration offset;
    double speed;
  };
  // Needs bounds.
  [[nodiscard]] Likely likely(HostTime now) const;
  // Echoes that the interval rests on.
  [[nodiscard]] std::uint64_t exchanges() const { return exchanges_; }
  // Of the last echo: there and back, without the time that they held it.
  [[nodiscard]] std::optional<Duration> round_trip() const { return round_trip_; }

 private:
  // What one direction's last datagrams said of the offset: each is wrong by its delay.
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
  // A sample's offset from origin_ [s], by `now` at that speed.
  [[nodiscard]] double by_now_s(const Direction::Sample& sample, HostTime now, double speed) const;

  std::optional<Duration> least_, most_;
  HostTime at_{};  // when they were so
  std::uint64_t exchanges_ = 0;
  std::optional<Duration> round_trip_;
  Direction to_us_, from_us_;
  Duration origin_{0};  // offsets are computed from here: a double holds no nanosecond since 1970
};

}  // namespace peerd::replication
