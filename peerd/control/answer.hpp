#pragma once
#include <string>
#include <string_view>

#include "peerd/os/traffic_counters.hpp"
#include "peerd/node/peer_node.hpp"

namespace peerd::api {

struct Answer {
  std::string line;    // JSON, without its end; empty: no reply is wanted
  bool leave = false;  // the peer was told to leave
};

// Does what one line asks of the peer. The node's outputs are to be drained after it. host_minus_wall: what this host's
// time is ahead of Unix time, for poses that tell theirs. `network`: goes with the peer's own counters; null: there is
// none.
[[nodiscard]] Answer answer(PeerNode& node, HostTime now, std::string_view request,
                            Duration host_minus_wall = Duration{0}, const net::TrafficCounters* network = nullptr);

// A datagram to the port for poses: the same request, of poses only, and no reply. What is wrong is counted.
void take_datagram(PeerNode& node, HostTime now, std::string_view datagram, Duration host_minus_wall);

// A reply that says why nothing was done.
[[nodiscard]] std::string refusal(const std::string& sentence);

}  // namespace peerd::api
