#pragma once
#include "collision/contact/contact.hpp"

namespace peerd::collision {

// first_contact() of two bodies' surfaces, polygon soup against polygon soup, by time_of_impact.hpp: at a hit they are
// nearer than advancement_tolerance_m() and `margin_m` >= 0 together. A soup has no inside: a body wholly within a closed mesh doesn't touch it.
//
// The polygon that the response is of: of all pairs within twice the tolerance then, ordered by the collider's polygon
// and the collidee's, the first whose collidee's polygon the collider comes towards, on the side where it is. Where no
// polygon is met so (an edge meets an edge, side by side), the normal is the direction between the two that met.
// Overlapping at 0: the least pair that touches, facing the middle of the collider.
[[nodiscard]] Contact mesh_contact(const MovingBody& collider, const MovingBody& collidee, double horizon_s,
                                   double margin_m = 0.0);

// Whether any polygons of the two bodies are as near as `distance_m`.
[[nodiscard]] bool surfaces_within(const MovingBody& a, const MovingBody& b, double distance_m);

}  // namespace peerd::collision
