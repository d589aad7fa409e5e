#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "peerd/peer/motion/motion_path.hpp"

namespace peerd::motion {

// Boids (Reynolds, "Flocks, herds and schools: a distributed behavioral model", SIGGRAPH 1987): each bird keeps clear
// of its neighbours, adopts their speed and direction, stays with them, and makes for a goal that wanders through the
// area.
struct FlockSettings {
  double speed_m_s = 12.0;
  double acceleration_m_s2 = 8.0;                // greatest magnitude
  double separation_m = 5.0;                     // distance to neighbours that a bird keeps
  double neighbour_m = 25.0;                     // distance up to which a bird sees others
  double goal_every_s = 10.0;                    // interval of new goals
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();  // box of the goals [m]
};

// The paths of all birds of one flock, which start from these places at t = times.begin_s.
[[nodiscard]] std::vector<std::vector<Knot>> flock(const FlockSettings& settings, std::uint64_t seed,
                                                   std::span<const Vec3> starts, PathTimes times);

}  // namespace peerd::motion
