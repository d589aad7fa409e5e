#pragma once
#include "collision/contact/contact.hpp"

namespace peerd::collision {

// A sphere around something that moves, in the world: no turning, and no acceleration.
struct MovingSphere {
  Vec3 center, velocity;  // [m], [m/s]
  double radius_m = 0.0;
};

// Time to contact of two moving bounding spheres, as definition 6 of the thesis measures it (equations 4.8-4.12, with
// |d0 + u t|^2 = r^2 in place of the misprinted 4.10): 0 when they overlap now; else the least of the two roots, a root
// in the past counting as twice its absolute value; +inf when the spheres never meet. Velocities only, no acceleration.
[[nodiscard]] double proximity_time_s(const MovingSphere& p, const MovingSphere& q);
[[nodiscard]] double proximity_time_s(const MovingBody& p, const MovingBody& q);

// Whether the polygons of two moving bodies may come nearer to each other than `margin_m` >= 0 within `within_s`, or
// are that near now; false is certain. True may also mean that they only come within twice the margin. It sharpens
// proximity_time_s(), whose spheres let much through: a long wall's sphere holds half the street. The cost is a few
// nodes of the hierarchies; the answer is true where kMaxIterations steps don't settle it, and where the bodies have no
// exact answer (has_exact_answer()).
[[nodiscard]] bool may_come_near(const MovingBody& p, const MovingBody& q, double within_s, double margin_m);

}  // namespace peerd::collision
