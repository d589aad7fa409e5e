#pragma once
#include <cstdint>

namespace peerd::config {

// A car on a grid of streets, on the right-hand side: at each crossing it goes on or turns at random, brakes before a
// turn and speeds up behind it. It is a kinematic bicycle steered by pure pursuit (Coulter, "Implementation of the pure
// pursuit path tracking algorithm", CMU-RI-TR-92-01, 1992): the heading changes only as it moves, and the curvature
// only as fast as a wheel can be turned. Cars don't see each other.
struct DriveSettings {
  double speed_m_s = 12.0;                    // on a free street, within 15 % by car
  double acceleration_m_s2 = 2.0;             // at most, along and across, so 1.42 of it at all
  double block_m = 60.0;                      // from one street's middle to the next one's
  std::uint32_t blocks = 4;                   // each way, so there is one street more
  double lane_m = 1.75;                       // a lane's middle is so far right of the street's
  double origin_x_m = 0.0, origin_z_m = 0.0;  // the crossing of lowest x and z
};

}  // namespace peerd::config
