#pragma once
#include <optional>
#include <utility>

#include "core/time.hpp"
#include "replication/session/offset_interval.hpp"

namespace peerd::replication {

// What this host's operating system says of its clock, read at some instant.
struct OsClock {
  Duration minus_host;  // that clock minus the host clock
  Duration error;       // from UTC, at most
};

// Turns this host's time into the session's, which all peers share although their clocks differ.
//
// One peer leads: session time is its host time plus a constant. Every other follows one by what OffsetInterval knows
// of it. Session time never runs backwards: corrections are slewed, and a step goes forwards. So where the followed
// peer's time is far behind, it is not followed (Peer::choose_leader): its session comes forward to this one.
class SessionClock {
 public:
  // What is known of the followed peer's session time.
  struct Estimate {
    std::optional<OffsetBounds> bounds;  // its session time minus our host's; none: nothing any more
    Duration likely;                     // where in them it is, as far as anybody can tell
    double speed = 0.0;                  // .. and how fast that grows
    HostTime at;                         // when that was so
    std::int64_t drift_ppm = kDrift_ppm;
    Duration reference_error{0};  // how far the followed one may itself be from the session's time; 0: it leads
    bool settled = false;         // rests on enough exchanges: before, one queued packet could set the clock
  };

  // Whether session time is known, and how well.
  [[nodiscard]] bool synchronised() const { return leads_ || estimate_.has_value(); }
  // Session time is this peer's from now on: at first its host's, later as it has it.
  void lead(HostTime now);
  // After leading, time goes on as it is for `steady`, so that the others have heard before it is slewed.
  void follow(HostTime now, const Estimate& estimate, Duration steady);
  // This host did not run, or its clock jumped, by `gap` until `now`: session time goes on from where it was, and how
  // far that is off nobody knows until it follows or leads again.
  void stop(HostTime now, Duration gap);
  // To be called at every tick. How far the clock had to step forward: it was stopped, or two sessions have met.
  std::optional<Duration> adjust(HostTime now);

  // Both hold from the last adjust() on, and between two of them the clock is continuous.
  [[nodiscard]] SimTime to_session(HostTime host) const;
  // The first host time at which it is that late.
  [[nodiscard]] HostTime to_host(SimTime session) const;
  [[nodiscard]] Duration session_minus_host(HostTime now) const;
  // How far session time is from that of the leader, at most. 0 for the leader itself; none: nobody knows.
  [[nodiscard]] std::optional<Duration> error_bound(HostTime now) const;
  // What is still to be slewed.
  [[nodiscard]] Duration debt(HostTime now) const {
    return estimate_ ? likely(now) - session_minus_host(now) : Duration{0};
  }

 private:
  // Of the followed peer. Needs an estimate.
  [[nodiscard]] Duration likely(HostTime now) const;

  bool leads_ = false;
  bool has_time_ = false;             // ever led or followed
  std::optional<Estimate> estimate_;  // while following; its bounds are known
  Duration offset_{0};                // session - host at adjusted_at_
  Duration debt_{0};                  // what is slewed from adjusted_at_ on
  std::int64_t slew_divisor_ = 1;     // .. by one of so many nanoseconds
  HostTime adjusted_at_{};
  HostTime steady_until_ = HostTime::min();
};

}  // namespace peerd::replication
