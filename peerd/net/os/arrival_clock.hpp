#pragma once
#include <optional>

#include "core/time.hpp"
#include "peerd/net/os/host_clock.hpp"

namespace peerd::net {

// Converts the kernel's timestamps of datagrams, which are of the wall clock, to the time of HostClock.
//
// Linux runs both clocks at the same rate (NTP slews both); their difference changes only when the wall clock is set.
// So each pair of readings bounds the difference, all bounds since the last step overlap, and a pair whose bounds do
// not overlap them shows a step. Timestamps from before a step cannot be converted afterwards.
class ArrivalClock {
 public:
  // The longest time from a datagram's timestamp to its entry into the queue of its socket, behind other datagrams.
  static constexpr Duration kStampToQueue = std::chrono::milliseconds(100);
  // The disagreement of two pairs that is not a step: each clock is rounded in its own way.
  static constexpr Duration kRounding = std::chrono::microseconds(1);

  // Takes a pair of readings: after each read of a socket, before arrival() of the datagrams that were read, in the
  // order of the readings.
  void on_pair(const HostClock::Pair& pair);

  // The arrival time of a datagram that was read before the last pair. `empty_at` is a time before that read such that
  // its socket's queue was empty then or later. None where the wall clock has been set in the meantime.
  [[nodiscard]] std::optional<HostTime> arrival(Duration wall_stamp, HostTime empty_at) const;

 private:
  std::optional<HostClock::Pair> last_;
  Duration host_minus_wall_least_{}, host_minus_wall_most_{};
  std::optional<HostTime> stepped_;  // the time at which the last step was found
};

}  // namespace peerd::net
