#pragma once
#include <limits>
#include <optional>

#include "collision/exact/orientation.hpp"
#include "collision/exact/triangle.hpp"

namespace peerd::collision {

// The points origin + t * direction with 0 <= t <= longest, in the frame of a soup [m]. t counts directions: it is a
// length [m] only where the direction is a unit vector.
struct Ray {
  Vec3 origin;
  Vec3 direction;
  double longest = std::numeric_limits<double>::infinity();
};

// What can be asked: coordinates of the origin within 2^130 m, the direction's largest component from 2^-500 to 2^500,
// so not zero, and longest >= 0. No t of a soup's point over- or underflows then (but to what is 0 to all purposes),
// and nothing that is infinite or no number passes.
[[nodiscard]] bool is_usable(const Ray& ray);

// Where a ray, longest apart, first meets a triangle: the least t >= 0 of a common point; none where there is none.
//
// Whether there is one is exact, of the real ray and the closed triangle, so a ray through an edge or a vertex hits all
// that share it. In its plane a ray hits a triangle where it enters it, and where the origin is in it at 0; without an
// area a triangle is a segment or a point. The parameter is the real one rounded to nearest, ties to even: wrong by
// half a unit in the last place, and equal for all triangles that are met in one point.
[[nodiscard]] std::optional<double> first_parameter(const Ray& ray, const Triangle& triangle,
                                                    OrientationCounters& counters);

}  // namespace peerd::collision
