#pragma once
#include <expected>

#include "peerd/transport/multicast_socket.hpp"

namespace peerd::net {

struct ProbeResult {
  ChosenInterface over;
  Duration took{0};      // from sending to hearing it
  bool stamped = false;  // by the kernel
  int receive_buffer_bytes = 0;
  std::optional<std::size_t> memberships_max;  // of one socket
};

// Whether a datagram that this computer sends to the first group of the plan comes back through its own kernel, on a
// port of its own. Takes as long as a datagram does, at most 0.3 s where none comes. It says nothing about what lies
// beyond: an access point or a switch that swallows multicast is not noticed.
[[nodiscard]] std::expected<ProbeResult, NetError> probe_multicast(const HostClock& clock, MulticastOptions options);

}  // namespace peerd::net
