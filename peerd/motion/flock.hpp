#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "peerd/motion/motion_path.hpp"

namespace peerd::config {

// Boids (Reynolds, "Flocks, herds and schools: a distributed behavioral model", SIGGRAPH 1987): each keeps clear of its
// neighbours, flies as fast and where they fly, keeps with them, and makes for a goal that wanders through the area.
struct FlockSettings {
  double speed_m_s = 12.0;
  double acceleration_m_s2 = 8.0;                // at most
  double separation_m = 5.0;                     // neighbours within this are kept clear of
  double neighbour_m = 25.0;                     // how far each one sees
  double goal_every_s = 10.0;                    // a new goal after that time
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();  // the goals are in this box [m]
};

// All of one flock, from their places at t = times.begin_s.
[[nodiscard]] std::vector<std::vector<Knot>> flock(const FlockSettings& settings, std::uint64_t seed,
                                                   std::span<const Vec3> starts, PathTimes times);

}  // namespace peerd::config
