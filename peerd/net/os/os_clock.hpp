#pragma once
#include <optional>

#include "peerd/net/os/host_clock.hpp"
#include "replication/session/session_clock.hpp"

namespace peerd::net {

// Reads CLOCK_REALTIME together with the error bound that the kernel states while NTP or PTP steers the clock: its
// maxerror, plus the duration of this reading. None where the kernel knows no bound (STA_UNSYNC: nothing steers the
// clock, or it has just been set), or while a leap second is inserted. ntp_adjtime(3) needs no privilege for this.
[[nodiscard]] std::optional<replication::OsClock> read_os_clock(const HostClock& clock);

}  // namespace peerd::net
