#pragma once
#include <optional>

#include "collision/contact/contact.hpp"

namespace peerd::collision {

struct ContactOptions {
  MeetAs as = MeetAs::kSurfaces;
  double margin_m = 0.0;
};

// Finds when two moving bodies first come to touch while approaching each other, within [0, horizon_s] (finite).
//
// *Touching at 0* is a gap between -(e + |closing speed| * kClockTick_s) and e on some separating axis, all other axes
// overlapping. e is the rounding bound of the gap, from the magnitudes of positions, radii and velocities; a speed
// below its own rounding bound counts as none. A body that was moved to its contact time, rounded to the clock, touches
// by this rule. Then, on the touching axes:
//   one parts       -> that contact was answered before (a bounce begins so); the search goes on to the next one;
//   one approaches  -> kContact at 0;
//   one is pressed  -> kContact at 0, resting: no speed along the axis and accelerated inwards, or parting so slowly
//                      that the acceleration ends it within e or within one tick;
//   one is still    -> no contact: the one glides along the other (a floor; the next slab of it, flush with this one).
//                      Two flat polygons in one plane can meet in it; the search goes on to what follows once they
//                      parted.
// Where a body turns, still can't be told from pressed: all that touch and don't part are contacts, resting where no
// speed closes them.
// Bodies whose surfaces are in each other at 0 deeper than touching are kOverlapped, with normal_world the direction of
// least penetration; with MeetAs::kSolids also those of which one is inside the other.
//
// Without rotation the answer is in closed form for accelerations that are constant: on each separating-axis candidate
// the gap is a quadratic in t, and the bodies overlap where all gaps are <= 0; to pass by in touch is a contact,
// unless the touch is there at 0 and the one glides along the other. With rotation it is conservative advancement
// (Mirtich, PhD, Berkeley 1996) on the largest gap: never later than the truth, at most advancement_tolerance_m() short
// of it, so that a pass within that tolerance may be taken for a contact.
//
// A body that is one Sphere (Body::sphere) meets another such body, and the polygons of others, as the sphere it is
// (sphere_contact.hpp, sphere_surface_contact.hpp): a ball doesn't bounce off its facets. The normal is the line of the
// two centres, the normal of the polygon whose inside the sphere meets, or the line from an edge or a corner to the
// centre.
//
// CollisionType::kBox uses the tight world boxes of all vertices in place of the polygons, and answers where only
// polygons are unsupported.
// MeetAs::kPolygons: the two meet by their polygons alone. A Sphere is its polygons. `margin_m` > 0: the paths of the
// two are known to so much, and what comes so near is a contact; the two then meet as polygons too, and answers are
// never later than the truth, and earlier by a distance of at most the margin and the tolerance.
[[nodiscard]] Contact first_contact(const MovingBody& collider, const MovingBody& collidee, CollisionType type,
                                    double horizon_s, const ContactOptions& options = {});

// Whether two bodies touch as they stand, or are nearer than contact times leave them: to within twice
// advancement_tolerance_m(), by their distance; of two convex pieces by the widest gap between them, which is less than
// their distance where a corner is nearest. As solids they also touch where one is inside the other. The two must have
// an exact answer (has_exact_answer()), but for kBox.
[[nodiscard]] bool touching(const MovingBody& a, const MovingBody& b, CollisionType type,
                            const ContactOptions& options = {});

// A plane between two bodies: the one has all of its vertices, or its sphere, at least `gap_m` >= 0 before the other.
struct PartingPlane {
  Vec3 normal_world;  // unit, facing the first body
  double gap_m;
};
// The plane that leaves the widest gap, among the directions that can part two convex pieces, two Spheres, or a Sphere
// and the faces of a convex piece. None: they touch, or are none of these.
[[nodiscard]] std::optional<PartingPlane> widest_parting(const MovingBody& a, const MovingBody& b);

// Whether first_contact() has an answer other than kUnsupported for their polygons: neither is unsupported itself, and
// where one isn't all convex pieces, both are within 2^58 m.
[[nodiscard]] bool has_exact_answer(const Body& a, const Body& b);
// Whether it has with every other body of which this holds, too.
[[nodiscard]] bool has_exact_answers(const Body& body);

}  // namespace peerd::collision
