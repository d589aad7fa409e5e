#pragma once
#include <cstdint>
#include <vector>

#include "peerd/peer/motion/motion_path.hpp"

namespace peerd::motion {

inline constexpr double kWalkWidthMin_m = 10.0;  // least width of an area in which a walker can turn
inline constexpr double kWalkMargin_m = 1.0;     // least distance of the start from the border, to stop in time

// A walker in an area. One Ornstein-Uhlenbeck process drives how fast the heading turns, another one drives the speed;
// now and then the walker stands still for a while; near a border it turns back and, if need be, slows down. The
// defaults are a crowd's: free walking is 1.34 m/s with a deviation of 0.26 m/s between people (Weidmann,
// "Transporttechnik der Fussgaenger", 1993).
struct WalkSettings {
  double speed_m_s = 1.3;     // mean over the walkers
  double speed_sd_m_s = 0.2;  // standard deviation between walkers; half of it over time
  double turn_rad_s = 0.4;    // standard deviation of the turn rate
  double turn_memory_s = 1.0;
  double stop_every_s = 30.0;  // mean time between stops; 0: none
  double stop_s = 4.0;         // mean length of a stop
  double x_min_m = 0.0, z_min_m = 0.0, x_max_m = 0.0, z_max_m = 0.0;
};

// The path of walker number `n`, from `start` at t = times.begin_s. It stays in the area.
[[nodiscard]] std::vector<Knot> walk(const WalkSettings& settings, std::uint64_t seed, std::size_t n, const Vec3& start,
                                     PathTimes times);

}  // namespace peerd::motion
