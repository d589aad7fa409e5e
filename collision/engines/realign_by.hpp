#pragma once
#include <cstdint>

namespace peerd::collision::engines {

// How a k-DOP is taken to another frame.
enum class RealignBy : std::uint8_t {
  kSlabs,     // by combinations of three of its slabs (realignment.hpp): no vertices
  kBoundary,  // by the vertices of its boundary: Klosowski's approximation method (Ohlenburg 2003, 3.2.3)
  kHull,      // the root by the vertices of the convex hull of all that is in it, all other nodes by their boundaries
};

}  // namespace peerd::collision::engines
