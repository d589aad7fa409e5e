#pragma once
#include <string>
#include <vector>

#include "../figures.hpp"

namespace peerd::bench {

// How long an update is under way between two processes of this computer, from the call that publishes it to the
// observer's callback; beside the same by bare UDP multicast and by Cyclone DDS (left out where there is no ddsperf).
// A ping-pong, and (.1khz) a ping every millisecond. The three take turns, so that whatever else runs here hits them
// alike; peers and bare UDP besides without ever sleeping (transport.busy_poll_us), each ratio to the round of the same
// turn. As ddsperf measures half a round trip, so do all; what one way takes is a figure of the peers besides.
struct LoopbackResult {
  std::vector<Figure> figures;
  std::vector<std::string> wrong;  // empty: every ping and pong came, and said what it should
};
[[nodiscard]] LoopbackResult measure_loopback(bool quick);

// growth.OBJECTS.loopback_p50_over_udp.1khz, .._p99_..: that of peers that sleep over that of bare UDP, with so many
// objects in the world, of which each of the two runs half: those that nothing is asked of stand where the file has
// them.
[[nodiscard]] LoopbackResult measure_loopback_growth(bool quick);

}  // namespace peerd::bench
