#pragma once
#include <cstdint>

namespace peerd::motion {

// A car on a grid of streets, on the right-hand side: at each crossing it goes on or turns at random, brakes before a
// turn and speeds up behind it. It is a kinematic bicycle steered by pure pursuit (Coulter, "Implementation of the pure
// pursuit path tracking algorithm", CMU-RI-TR-92-01, 1992): the heading changes only as it moves, and the curvature
// only as fast as a wheel can be turned. Cars don't see each other.
struct DriveSettings {
  double speed_m_s = 12.0;                    // on a free street; each car's differs by up to 15 %
  double acceleration_m_s2 = 2.0;             // greatest along and across, so 1.42 times that in all
  double block_m = 60.0;                      // from the middle of one street to that of the next
  std::uint32_t blocks = 4;                   // number each way; there is one street more
  double lane_m = 1.75;                       // distance of a lane's middle from the street's, to the right
  double origin_x_m = 0.0, origin_z_m = 0.0;  // crossing with the lowest x and z
};

}  // namespace peerd::motion
