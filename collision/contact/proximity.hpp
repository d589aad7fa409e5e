#pragma once
#include "collision/contact/contact.hpp"

namespace peerd::collision {

// Time to contact of two moving bounding spheres, as the seed's definition 6 measures it (equations 4.8-4.12, with
// |d0 + u t|^2 = r^2 in place of the misprinted 4.10): 0 when they overlap now; else the least of the two roots, a root
// in the past counting as twice its absolute value; +inf when the spheres never meet. Velocities only, no acceleration.
[[nodiscard]] double proximity_time_s(const MovingBody& p, const MovingBody& q);

// Whether their polygons may come nearer to each other than `margin_m` > 0 within `within_s`, or are that near now, as
// both move; false is certain. True may be of what only comes within twice the margin. Of what the spheres let through
// most is no danger: a long wall's sphere holds half the street. Costs a few nodes of the hierarchies; what isn't
// settled by kMost steps may come near, and so may what has no surface to ask (has_exact_answer()).
[[nodiscard]] bool may_come_near(const MovingBody& p, const MovingBody& q, double within_s, double margin_m);

}  // namespace peerd::collision
