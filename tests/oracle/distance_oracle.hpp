#pragma once
#include <gmpxx.h>

#include "tests/oracle/triangle_oracle.hpp"

namespace peerd::oracle {

// The square of the distance of two triangles, exact for all finite coordinates: the least over all pairs of corners,
// and of edges and faces where those are nearest inside.
[[nodiscard]] mpq_class squared_distance(const Triangle& a, const Triangle& b);

// The same for two that share no point, with rational corners.
using RationalTriangle = std::array<std::array<mpq_class, 3>, 3>;
[[nodiscard]] mpq_class squared_distance_apart(const RationalTriangle& a, const RationalTriangle& b);

}  // namespace peerd::oracle
