#pragma once
#include "collision/contact/contact.hpp"

namespace peerd::collision {

// Whether one of the two is an exact sphere whose centre moves along a parabola (see meet_as_spheres()); the other one
// is met as its polygons.
[[nodiscard]] bool meet_as_sphere_and_surface(const MovingBody& a, const MovingBody& b);

// first_contact() of two bodies for which meet_as_sphere_and_surface() holds, by the same rule of touching. Each
// triangle that is near the sphere's way is approached conservatively along the line from its nearest point to the
// centre: while neither turns that line's gap is a quadratic in time, so the steps are Newton's. They end where the gap
// is no more than its rounding bound, never after the truth. The normal is that of the polygon where the sphere meets
// its inside, and the line from the nearest point of an edge or a corner to the centre elsewhere.
[[nodiscard]] Contact sphere_surface_contact(const MovingBody& collider, const MovingBody& collidee, double horizon_s,
                                             MeetAs as);

// Whether the gap between the sphere and the other's polygons is no more than `distance_m`, or, as solids, its centre
// is in a convex piece.
[[nodiscard]] bool sphere_within_surface(const MovingBody& a, const MovingBody& b, double distance_m, MeetAs as);

}  // namespace peerd::collision
