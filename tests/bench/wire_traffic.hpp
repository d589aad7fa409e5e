#pragma once
#include <vector>

#include "figures.hpp"

namespace peerd::bench {

// What of the bytes on the wire a simulation tells, of configs/best.toml:
// bytes_over_dis[.SCENARIO.LATENCYms], of traffic and crowd: bytes a second over those of DIS
// (configs/baselines/dis.toml: an entity state PDU of 144 bytes for each update, nothing else) at the same mean error,
// UDP and IPv4 headers of both counted; the worst, and each. flock_received_over_aoi[.LATENCYms]: flock over 64
// regions, 8 peers: bytes of updates that a peer receives over those of what is in its area of interest; the worst, and
// each. Throws std::runtime_error where a run proves nothing.
[[nodiscard]] std::vector<Figure> wire_traffic(const Options& options);

}  // namespace peerd::bench
