#pragma once
#include <cstdint>
#include <vector>

#include "peerd/motion/motion_path.hpp"

namespace peerd::config {

inline constexpr double kWalkWidthMin_m = 10.0;  // of an area: a walker must be able to turn in it
inline constexpr double kWalkMargin_m = 1.0;     // and to stop at its border, so it begins so far inside

// Someone who walks about in an area: an Ornstein-Uhlenbeck process drives how fast the heading turns, another how fast
// the walker goes; now and then it stands for a while; near a border it turns back and, if need be, slows down. The
// defaults are a crowd's: free walking is 1.34 m/s, 0.26 m/s apart between people (Weidmann, "Transporttechnik der
// Fussgaenger", 1993).
struct WalkSettings {
  double speed_m_s = 1.3;     // of the walkers, on average
  double speed_sd_m_s = 0.2;  // between walkers, and of each one over time by half of it
  double turn_rad_s = 0.4;    // standard deviation of the turn rate
  double turn_memory_s = 1.0;
  double stop_every_s = 30.0;  // on average; 0: never
  double stop_s = 4.0;         // on average
  double x_min_m = 0.0, z_min_m = 0.0, x_max_m = 0.0, z_max_m = 0.0;
};

// Walker number `n`, from `start` at t = times.begin_s. It stays in the area.
[[nodiscard]] std::vector<Knot> walk(const WalkSettings& settings, std::uint64_t seed, std::size_t n, const Vec3& start,
                                     PathTimes times);

}  // namespace peerd::config
