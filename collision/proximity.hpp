#pragma once
#include "collision/contact_time.hpp"

namespace peerd::collision {

// Time to contact of two moving bounding spheres, as the seed's definition 6 measures it (equations 4.8-4.12, with
// |d0 + u t|^2 = r^2 in place of the misprinted 4.10): 0 when they overlap now; else the least of the two roots, a root
// in the past counting as twice its absolute value; +inf when the spheres never meet. Velocities only, no acceleration.
[[nodiscard]] double proximity_time_s(const MovingBody& p, const MovingBody& q);

}  // namespace peerd::collision
