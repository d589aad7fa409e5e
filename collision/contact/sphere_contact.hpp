#pragma once
#include "collision/contact/contact.hpp"

namespace peerd::collision {

// Whether both bodies are exact spheres whose centres move along parabolas: a sphere beside its body's origin goes on a
// circle when the body turns, and is left to its polygons.
[[nodiscard]] bool meet_as_spheres(const MovingBody& a, const MovingBody& b);

// first_contact() of two bodies for which meet_as_spheres() holds, by the same rule of touching. Their distance's
// square is a polynomial of degree 4 in time, whose first root is found by halving in Bernstein form: never later than
// the truth, and earlier by rounding alone. The normal is the line of centres.
[[nodiscard]] Contact sphere_contact(const MovingBody& collider, const MovingBody& collidee, double horizon_s,
                                     MeetAs as);

// Whether the gap between the two spheres is no more than `distance_m`; as solids also where one is inside the other.
[[nodiscard]] bool spheres_within(const MovingBody& a, const MovingBody& b, double distance_m, MeetAs as);

}  // namespace peerd::collision
