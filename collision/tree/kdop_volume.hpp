#pragma once
#include <vector>

#include "collision/tree/kdop.hpp"

namespace peerd::collision {

// The polygons that bound a k-DOP, cut plane by plane as in the thesis's 3.2.3: each face begins as a polygon that is
// larger than the whole and is cut by all other slabs. Faces that vanish are left out. Rounded: for volumes, pictures
// and the comparison of realignments, not for decisions.
template <int K>
[[nodiscard]] std::vector<std::vector<Vec3>> boundary(const WideKdop<K>& dop);

// The volume [m^3], rounded; 0 for an empty or flat k-DOP.
template <int K>
[[nodiscard]] double volume(const WideKdop<K>& dop);

}  // namespace peerd::collision
