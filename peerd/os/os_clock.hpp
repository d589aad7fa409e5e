#pragma once
#include <optional>

#include "peerd/os/host_clock.hpp"
#include "replication/session/session_clock.hpp"

namespace peerd::net {

// What the kernel says of CLOCK_REALTIME, as NTP or PTP steers it: its maxerror, and what this reading took. None: it
// does not know how right that clock is (STA_UNSYNC: nothing steers it, or it has just been set), or a leap second is
// being inserted. What ntp_adjtime(3) says, and no privilege is needed to ask.
[[nodiscard]] std::optional<replication::OsClock> read_os_clock(const HostClock& clock);

}  // namespace peerd::net
