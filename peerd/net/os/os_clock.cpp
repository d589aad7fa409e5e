#include "peerd/net/os/os_clock.hpp"

#include <sys/timex.h>

namespace peerd::net {

std::optional<replication::OsClock> read_os_clock(const HostClock& clock) {
  timex asked{};  // modes 0 changes nothing
  const int state = ntp_adjtime(&asked);
  // Without modes the only possible error is EFAULT. TIME_OOP is the 61st second, which the clock shows twice.
  if (state == -1 || state == TIME_ERROR || state == TIME_OOP || (asked.status & STA_UNSYNC) != 0) return std::nullopt;
  const HostClock::Pair pair = clock.pair_with_wall();
  const Duration half = (pair.after - pair.before) / 2;
  return replication::OsClock{pair.wall - (pair.before.time_since_epoch() + half),
                              std::chrono::microseconds(asked.maxerror) + half + Duration{1}};
}

}  // namespace peerd::net
