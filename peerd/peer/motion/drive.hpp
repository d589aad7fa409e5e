#pragma once
#include <cstdint>
#include <vector>

#include "peerd/peer/motion/drive_settings.hpp"
#include "peerd/peer/motion/motion_path.hpp"

namespace peerd::motion {

// The path of car number `n`, which is at t = times.begin_s on the lane nearest to `start`.
[[nodiscard]] std::vector<Knot> drive(const DriveSettings& settings, std::uint64_t seed, std::size_t n,
                                      const Vec3& start, PathTimes times);

}  // namespace peerd::motion
