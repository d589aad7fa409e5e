#pragma once
#include "collision/exact/triangle.hpp"

namespace peerd::collision {

// A lower bound of how deep two triangles are in each other [m], certain for all finite corners within
// kLargestCoordinate_m: while each corner of A is displaced, each in a direction of its own, by less than this, the two
// still touch. Displacements of both add up. So a pair that overlaps by more than its corners can have moved since, has
// touched all the time.
//
// With h(n) = max n.a - min n.b over the corners, the set of differences A - B is all x with n.x <= h(n) for all unit
// n, and the two touch where 0 is in it. Displacing corners by less than d lowers no h(n) by d, so the bound is the
// least h(n): the radius of the ball around 0 in A - B. That is the least over the normals of the facets of A - B,
// which are the normals of both faces and the products of their edges, to both sides: 11 axes (Ericson, Real-Time
// Collision Detection, 2005, 5.2.1). Of two triangles in one plane A - B has no inside, and the bound is 0.
//
// For triangles that do not touch it is 0. Else it is the radius, less at most 2^-33 of the largest difference of
// corners; a radius below 1e-250 m or so may be 0.
[[nodiscard]] double overlap_depth_m(const Triangle& a, const Triangle& b);

}  // namespace peerd::collision
