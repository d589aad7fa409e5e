#pragma once
#include <vector>

#include "figures.hpp"

namespace peerd::bench {

// The figures are what a simulation with configs/best.toml tells of the bytes on the wire. The function throws
// std::runtime_error where a run proves nothing.
//
// bytes_over_dis[.SCENARIO.LATENCYms], of traffic and crowd: bytes a second over those of DIS
// (configs/baselines/dis.toml: an entity state PDU of 144 bytes for each update, nothing else) at the same mean error,
// UDP and IPv4 headers of both counted; the worst, and each. `.updates`: of ours too only what tells of objects, all
// headers of a datagram for each instant of a peer.
//
// flock_received_over_aoi[.LATENCYms]: flock over 64 regions, 8 peers: bytes of updates that a peer receives over those
// of what is in its area of interest, of the peer that has the most; at the worst latency, and at each. `.all`: of the
// sum of all peers.
//
// growth.OBJECTS.bytes_over_dis: of a peer that tells another of an eleventh of the objects, which walk and drive
// (wire_objects.hpp), hellos of both included. growth.OBJECTS.flock_received_over_aoi: with so many birds.
[[nodiscard]] std::vector<Figure> wire_traffic(const Options& options);

}  // namespace peerd::bench
