#pragma once
#include <optional>
#include <utility>

#include "core/time.hpp"
#include "replication/session/offset_interval.hpp"

namespace peerd::replication {

// The operating system's clock of this host, read at some instant.
struct OsClock {
  Duration minus_host;  // the operating system's clock minus the host clock
  Duration error;       // the greatest distance of that clock from UTC
};

// Turns this host's time into the session's, which all peers share although their clocks differ.
//
// One peer leads: session time is its host time plus a constant. Every other peer follows one by the bounds of its
// OffsetInterval. Session time never runs backwards: corrections are slewed, and a step goes forwards. So a peer whose
// time is far behind is not followed (SessionTime::choose_leader): its session comes forward to this one.
class SessionClock {
 public:
  // The followed peer's session time, as far as it is known.
  struct Estimate {
    std::optional<OffsetBounds> bounds;  // its session time minus this host's clock; none: not known any more
    Duration likely;                     // the likely value within the bounds
    double speed = 0.0;                  // the rate at which `likely` grows
    HostTime at;                         // the time of the bounds and of `likely`
    std::int64_t drift_ppm = kDrift_ppm;
    Duration reference_error{0};  // the followed peer's own error bound; 0: it leads
    bool settled = false;         // rests on enough exchanges; with fewer, one queued packet could set the clock
  };

  // Whether session time is known.
  [[nodiscard]] bool synchronised() const { return leads_ || estimate_.has_value(); }
  // This peer leads from now on: session time is at first its host's time, `ahead` of it (>= 0), later the time that it
  // has.
  void lead(HostTime now, Duration ahead = Duration{0});
  // Follows another peer. After leading, time goes on unchanged for `steady`, so that the other peers know before it
  // is slewed.
  void follow(HostTime now, const Estimate& estimate, Duration steady);
  // This host did not run, or its clock jumped, by `gap` until `now`: session time goes on from where it was, and its
  // error is unknown until this peer follows or leads again.
  void stop(HostTime now, Duration gap);
  // The caller calls it at every tick. Returns the step forward that the clock had to make, > 0: it was stopped, or two
  // sessions have met.
  std::optional<Duration> adjust(HostTime now);

  // These conversions hold from the last adjust() on, and between two of them the clock is continuous.
  [[nodiscard]] SimTime to_session(HostTime host) const;
  // The first host time at which session time is not before `session`.
  [[nodiscard]] HostTime to_host(SimTime session) const;
  [[nodiscard]] Duration session_minus_host(HostTime now) const;
  // The greatest distance of session time from that of the leader. 0 for the leader itself; none: not known.
  [[nodiscard]] std::optional<Duration> error_bound(HostTime now) const;
  // The correction that is still to be slewed.
  [[nodiscard]] Duration debt(HostTime now) const {
    return estimate_ ? likely(now) - session_minus_host(now) : Duration{0};
  }

 private:
  // The likely offset from the followed peer. There is an estimate.
  [[nodiscard]] Duration likely(HostTime now) const;

  bool leads_ = false;
  bool has_time_ = false;             // has ever led or followed
  std::optional<Estimate> estimate_;  // while following; its bounds are known
  Duration offset_{0};                // session time minus host time at adjusted_at_
  Duration debt_{0};                  // the correction that is slewed from adjusted_at_ on
  std::int64_t slew_divisor_ = 1;     // one nanosecond is slewed in so many
  HostTime adjusted_at_{};
  HostTime steady_until_ = HostTime::min();
};

}  // namespace peerd::replication
