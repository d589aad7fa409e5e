#pragma once
#include "collision/contact/contact.hpp"

namespace peerd::collision {

// first_contact() of two bodies' surfaces, polygon soup against polygon soup, by time_of_impact.hpp: at a hit they are
// nearer than advancement_tolerance_m() and twice `margin_m` >= 0 together,
// and before it nothing is as near as `margin_m`. A soup has no inside: a body wholly within a closed mesh doesn't
// touch it.
//
// The polygon that the response is of: of all pairs within twice the tolerance then, ordered by the collider's polygon
// and the collidee's, the first whose collidee's polygon the collider comes towards, on the side where it is. Where no
// polygon is met so (an edge meets an edge, side by side), the normal is the direction between the two that met.
// Overlapping at 0: the least pair that touches, facing the middle of the collider.
[[nodiscard]] Contact mesh_contact(const MovingBody& collider, const MovingBody& collidee, double horizon_s,
                                   double margin_m = 0.0);

// A lower bound of how deep the polygons of two bodies that touch are in each other [m] (overlap_depth_m()): while no
// corner of either is displaced by as much, both displacements added, they go on to touch. 0: nothing is known.
[[nodiscard]] double touch_depth_m(const MovingBody& a, const MovingBody& b);

// Whether polygons of two different Shapes touch, as the two bodies stand. They may have Shapes in common.
[[nodiscard]] bool different_shapes_touch(const MovingBody& a, const MovingBody& b);

// Whether any polygons of the two bodies are as near as `distance_m`.
[[nodiscard]] bool surfaces_within(const MovingBody& a, const MovingBody& b, double distance_m);

}  // namespace peerd::collision
