#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace peerd::sim::testing_support {

// The inner half width of a room [m]: its walls are the planes at this distance from its middle, on all six sides.
inline constexpr double kRoomHalf_m = 3.0;

// A room that nothing can leave, what flies in it, and the network of the peers that own it.
struct ClosedRoom {
  std::string world;                 // VRML97
  std::string scenario;              // TOML; its world is room.wrl
  std::vector<double> gravity_m_s2;  // along y, of each body O0, O1, ..
  bool one_owner;
  bool steady;  // the network and the peers stay what they are
};

// Of 2 to 10 bodies: spheres, boxes, cones, cylinders and prisms over an L; scaled, turned; all responses, masses from
// 1 to 1e5, restitution 0 to 1, friction; some under gravity. 1 to 5 peers, all decision policies, latency up to 0.8 s
// and changes of it, loss up to one half, jitter, duplicates, reordering, partitions, kills, leaves and joins. The same
// seed gives the same room on every machine.
[[nodiscard]] ClosedRoom make_closed_room(std::uint64_t seed);

}  // namespace peerd::sim::testing_support
