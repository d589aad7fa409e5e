#pragma once
#include <cstdint>
#include <map>
#include <string>

#include "island_world.hpp"

namespace peerd::bench {

// The traffic of one kind that a peer has received, or sent, in a second of the measured part: the mean of all peers.
struct Rate {
  double datagrams = 0.0, bytes = 0.0;
};

struct IslandCosts {
  std::uint32_t peers = 0, objects = 0;
  std::map<std::string, Rate> in;  // by kind
  Rate in_all, out_all, in_worst;  // in_worst: of the peer that receives the most bytes
  double members = 0.0, near_members = 0.0, regions = 0.0, received_objects = 0.0;  // means over the peers, at the end
  double clock_error_ms = 0.0;  // the worst at the end, of any peer against the leader
  double decisions = 0.0;
  std::size_t lost = 0;          // times that a peer has lost another one in the measured part, where all are here
  double memory_bytes = 0.0;     // resident memory of the process, for each peer
  double allocated_bytes = 0.0;  // what the peers have allocated, also where they have not touched it
  double cpu_s = 0.0;            // of the measured part, for each peer and second of it
  double took_s = 0.0;
  std::string wrong;  // why the run proves nothing; empty if it does
};

// Runs it on the simulated network. Throws std::runtime_error where it cannot.
[[nodiscard]] IslandCosts run_islands(const IslandWorld& world);

}  // namespace peerd::bench
