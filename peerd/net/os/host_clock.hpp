#pragma once
#include "core/time.hpp"

namespace peerd::net {

// The host time of a peer [ns since the Unix epoch]: the only clock that is read for a peer.
//
// The wall clock is read once, at construction; from then on time runs by CLOCK_BOOTTIME, which continues while the
// computer is suspended. So host time never steps and never runs backwards, whatever an administrator or an NTP daemon
// does to the wall clock. The host times of two computers may therefore differ by seconds, and drift; the session clock
// measures and removes that.
class HostClock {
 public:
  // `test_offset` is a test setting, which is added to the time of the computer.
  explicit HostClock(Duration test_offset = Duration{0});
  [[nodiscard]] HostTime now() const;
  // The difference from the wall clock to now(), at this instant. It converts Unix times of other programs on this
  // computer to host time, even where the wall clock has been set since construction.
  [[nodiscard]] Duration minus_wall() const;
  // A reading of the wall clock (Unix time) between two readings of this clock.
  struct Pair {
    HostTime before;
    Duration wall;
    HostTime after;
  };
  [[nodiscard]] Pair pair_with_wall() const;

 private:
  Duration epoch_minus_boot_time_;  // test offset included
};

}  // namespace peerd::net
