#pragma once
#include <algorithm>
#include <vector>

#include "collision/tree/kdop.hpp"

namespace peerd::collision {

// Stored slabs as a computation takes them; exact.
template <int K>
[[nodiscard]] WideKdop<K> widened(const Kdop<K>& dop) {
  WideKdop<K> out;
  std::ranges::copy(dop.lo, out.lo.begin());
  std::ranges::copy(dop.hi, out.hi.begin());
  return out;
}

// The polygons that bound a k-DOP, cut plane by plane as in the thesis's 3.2.3: each face begins as a polygon that is
// larger than the whole and is cut by all other slabs. Faces that vanish are left out. Rounded: for volumes, pictures
// and the comparison of realignments, not for decisions.
template <int K>
[[nodiscard]] std::vector<std::vector<Vec3>> boundary(const WideKdop<K>& dop);

// The volume [m^3], rounded; 0 for an empty or flat k-DOP.
template <int K>
[[nodiscard]] double volume(const WideKdop<K>& dop);

}  // namespace peerd::collision
