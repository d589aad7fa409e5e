#pragma once
#include <gmpxx.h>

#include "tests/oracle/triangle_oracle.hpp"

namespace peerd::oracle {

// The square of the distance of two triangles, exact for all finite coordinates: the least over all pairs of corners,
// and of edges and faces where those are nearest inside.
[[nodiscard]] mpq_class squared_distance(const Triangle& a, const Triangle& b);

}  // namespace peerd::oracle
