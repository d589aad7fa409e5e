#pragma once
#include <optional>

#include "core/time.hpp"
#include "peerd/os/host_clock.hpp"

namespace peerd::net {

// Turns the kernel's stamps of datagrams, which are of the wall clock, into HostClock's time.
//
// Linux lets both clocks run alike (NTP slews both); what they differ by changes only when the wall clock is set. So
// each pair of readings bounds the difference, all pairs since the last step hold together, and one that doesn't
// overlap them is a step. What was stamped before a step, nobody can tell afterwards.
class ArrivalClock {
 public:
  // Longest that a datagram is under way from its stamp to the queue of its socket, behind other datagrams.
  static constexpr Duration kStampToQueue = std::chrono::milliseconds(100);
  // What two pairs may disagree by though nothing was set: both clocks are rounded, each in its own way.
  static constexpr Duration kRounding = std::chrono::microseconds(1);

  // After each read of a socket and before arrival() of what it gave; in the order of the readings.
  void on_pair(const HostClock::Pair& pair);

  // When a datagram came that the last pair was read after. `empty_at`: its socket's queue was empty at some time
  // after that, before the read. None: the wall clock was set meanwhile.
  [[nodiscard]] std::optional<HostTime> arrival(Duration wall_stamp, HostTime empty_at) const;

 private:
  std::optional<HostClock::Pair> last_;
  Duration host_minus_wall_least_{}, host_minus_wall_most_{};
  std::optional<HostTime> stepped_;  // when a step was found
};

}  // namespace peerd::net
