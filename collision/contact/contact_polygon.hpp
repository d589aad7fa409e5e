#pragma once
#include "collision/contact/contact.hpp"
#include "collision/contact/separating_axis.hpp"

namespace peerd::collision {

// The collidee's polygon whose face the axis n is (n: world, unit, from the collidee towards the collider): the lowest
// index; -1 when n is no face's normal. A flat polygon faces both ways.
[[nodiscard]] std::int64_t face_along(const Solid& collidee, const Mat3& R_world_collidee, const Vec3& n_world);

// Fills in normal, Shape and polygon of a contact that closes along n. A face's normal where n is one; otherwise that
// of the lowest polygon around the touching corner or edge that the collider's velocity relative to it runs against;
// otherwise n itself. e [m] is the rounding bound of a vertex's distance along n.
void set_contact_polygon(Contact& contact, const Solid& collidee, const Mat3& R_world_collidee, const Vec3& n_world,
                         const Vec3& approach_velocity_world, double e);

}  // namespace peerd::collision
