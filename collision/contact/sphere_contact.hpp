#pragma once
#include "collision/contact/contact.hpp"

namespace peerd::collision {

// Whether both are round and stay so: a sphere beside its body's origin goes on a circle when the body turns, and is
// left to its polygons.
[[nodiscard]] bool meet_as_spheres(const MovingBody& a, const MovingBody& b);

// first_contact() of two such bodies, by the same rule of touching. Their distance's square is a polynomial of degree 4
// in time, whose first root is found by halving in Bernstein form: never later than the truth, and earlier by rounding
// alone. The normal is the line of centres.
[[nodiscard]] Contact sphere_contact(const MovingBody& collider, const MovingBody& collidee, double horizon_s);

// Whether there is no more than that between them.
[[nodiscard]] bool spheres_within(const MovingBody& a, const MovingBody& b, double distance_m);

}  // namespace peerd::collision
