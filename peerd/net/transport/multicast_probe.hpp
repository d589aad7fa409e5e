#pragma once
#include <expected>

#include "peerd/net/transport/multicast_socket.hpp"

namespace peerd::net {

struct ProbeResult {
  ChosenInterface over;
  Duration took{0};      // from sending to receiving
  bool stamped = false;  // whether the kernel timestamps datagrams
  int receive_buffer_bytes = 0;
  std::optional<std::size_t> memberships_max;  // groups of one socket; none: unknown
};

// Checks whether a datagram to the first group of the plan comes back through this computer's kernel, on a port that no
// peer uses; where none does, whether one to a group that no peer joins comes back on the peers' port. The check takes
// as long as a datagram does, and at most 0.3 s for each port. It says nothing about the network beyond: it does not
// notice an access point or a switch that discards multicast.
[[nodiscard]] std::expected<ProbeResult, NetError> probe_multicast(const HostClock& clock, MulticastOptions options);

}  // namespace peerd::net
