#pragma once
#include <array>
#include <cstddef>

#include "core/time.hpp"

namespace peerd::replication {

// Turns this host's time into the session's, which all peers share although their clocks differ.
//
// One peer founds the session: session time is its host time. Every other follows a synchronised peer by NTP's four
// stamps (RFC 5905, section 8), carried by multicast hellos: of the last kSamples exchanges the one with the least
// round trip names the offset, since queueing only ever adds. Session time never runs backwards: corrections are
// slewed, except into another session whose time is farther away than slewing could mend.
class SessionClock {
 public:
  // Our hello left at t1, they got it at t2, theirs left at t3, we got it at t4: t1 and t4 on our clock, t2 and t3 as
  // they had the session's time at t3.
  struct Exchange {
    HostTime t1;
    SimTime t2, t3;
    HostTime t4;
  };

  [[nodiscard]] bool synchronised() const { return synchronised_; }
  // This host's clock becomes the session's.
  void found_session();
  void on_exchange(const Exchange& exchange);
  // Another peer is followed from now on: what was learnt of the last one does not describe it.
  void follow_another();
  // Moves the session clock towards the estimate. True when it had to step (two sessions have met).
  bool adjust(HostTime now);

  [[nodiscard]] SimTime to_session(HostTime host) const { return SimTime{(host.time_since_epoch() + offset_)}; }
  [[nodiscard]] HostTime to_host(SimTime session) const { return HostTime{(session.time_since_epoch() - offset_)}; }
  [[nodiscard]] Duration session_minus_host() const { return offset_; }
  // Half the best round trip: no asymmetry of the paths can make the error larger. 0 for the founder.
  [[nodiscard]] Duration error_bound() const;

 private:
  struct Sample {
    Duration offset, round_trip;
  };
  static constexpr std::size_t kSamples = 16;
  // Before this many exchanges a single queued packet could still set the clock. (Exchanges may share one of our
  // hellos: the way back is then measured anew, the way there is not.)
  static constexpr std::size_t kSamplesToStart = 4;

  [[nodiscard]] const Sample& best() const;

  std::array<Sample, kSamples> samples_{};
  std::size_t sample_count_ = 0;  // ever taken since follow_another
  bool synchronised_ = false;
  Duration error_bound_{0};
  Duration offset_{0};
  HostTime adjusted_at_{};
};

}  // namespace peerd::replication
