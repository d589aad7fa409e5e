#pragma once
#include <cstdint>
#include <vector>

#include "bench/scale/moving_bodies.hpp"
#include "core/time.hpp"
#include "replication/physics/world/motion_world.hpp"

// This header holds a whole peer among moving bodies, as the benchmark of growth measures it.
namespace peerd::bench {

struct PeerCost {
  double packets_s = 0.0, ticks_s = 0.0;  // of the thread's time, in all
  double simulated_s = 0.0;
  std::vector<double> shares;  // of a core, second by second
  std::uint64_t ticks = 0, updates_in = 0, updates_out = 0, contacts = 0;
  replication::MotionWorld::Counters motion;
  std::size_t unknown = 0;  // bodies of the other peer that the measured one knows nothing of
};

// Two peers 20 ms apart, in the same world: the measured one drives a tenth of the bodies, the other one the rest and
// finds no contacts. Both publish by the thesis's second order.
[[nodiscard]] PeerCost run_peer(const MovingBodies& bodies, Duration warm, Duration until);

}  // namespace peerd::bench
