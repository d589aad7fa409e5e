#pragma once
#include <cstdint>

#include "collision/exact/triangle_soup.hpp"
#include "core/kinematics.hpp"
#include "tests/collision/soups.hpp"

namespace peerd::bench::impact {

struct MovingMesh {
  collision::TriangleSoup soup;
  KinematicState motion;
};

struct MovingPair {
  const char* kind_a = "";
  const char* kind_b = "";
  MovingMesh a, b;
  double step_s = 1.0;
  double tolerance_m = 1e-6;
};

// Two meshes of any of eight kinds, of 1e-3 to 1e3 m (B from a thirtieth to thirty times as large as A, or A a floor a
// hundred times as large), up to 1e6 m from the world's origin, some with a frame whose origin is not in them. Speeds
// are from 0 to a hundred sizes a step, spins to 30 rad a step, accelerations to what makes a way of ten sizes; most
// are sent towards each other. Most, not all, start apart.
[[nodiscard]] MovingPair random_pair(collision::Numbers& numbers);

// No point of the soup is farther from its frame's origin.
[[nodiscard]] double radius_m(const collision::TriangleSoup& soup);

}  // namespace peerd::bench::impact
