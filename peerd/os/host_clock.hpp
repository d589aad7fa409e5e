#pragma once
#include "core/time.hpp"

namespace peerd::net {

// What a peer takes for the time of its computer [ns since the Unix epoch]. Nothing else reads a clock for it.
//
// now() reads the wall clock once, at construction; from then on time runs by CLOCK_BOOTTIME, which counts on while the
// computer is suspended. So it never steps and never runs backwards, whatever an administrator or an NTP daemon does to
// the wall clock. Two peers on two hosts may therefore differ by seconds, and drift: the session clock measures and
// removes that.
class HostClock {
 public:
  // test_offset: makes this process believe that it is that much later than its computer says (a test setting).
  explicit HostClock(Duration test_offset = Duration{0});
  [[nodiscard]] HostTime now() const;
  // What now() is ahead of the wall clock at this instant: turns what another program of this computer stamped by the
  // wall clock (Unix time) into this clock's time, whatever has been done to the wall clock since construction.
  [[nodiscard]] Duration minus_wall() const;
  // A reading of the wall clock (Unix time) between two of this one.
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
