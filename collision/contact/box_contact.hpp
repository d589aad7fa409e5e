#pragma once
#include <span>

#include "collision/contact/contact.hpp"
#include "core/box.hpp"

namespace peerd::collision {

// The world box of all vertices of a body that polygons use.
[[nodiscard]] WorldBox tight_box(const MovingBody& moving);

// The gap between the world boxes of all that is in `a` and all that is in `b` [m]: the greatest of the three axes;
// negative where they overlap, and +inf where one of them has no vertices.
[[nodiscard]] double box_gap_m(std::span<const MovingBody> a, std::span<const MovingBody> b);

// Finds when the world boxes of two ends first come as near as `margin_m` + 1e-6 m, for ends of several bodies that
// move in different ways. The search advances conservatively on the greatest gap: never later than the truth. The
// normal is the axis that closes last, and the shape is the first body of the collidee.
[[nodiscard]] Contact first_box_contact(std::span<const MovingBody> collider, std::span<const MovingBody> collidee,
                                        double horizon_s, double margin_m);

// A time for which the boxes, which overlap, certainly go on to overlap [s], as long as the states hold.
[[nodiscard]] double boxes_overlap_for_s(std::span<const MovingBody> a, std::span<const MovingBody> b,
                                         double horizon_s);

}  // namespace peerd::collision
