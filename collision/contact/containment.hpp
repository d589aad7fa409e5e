#pragma once
#include "collision/contact/contact.hpp"
#include "collision/exact/triangle_soup.hpp"

namespace peerd::collision {

// Whether the soup has triangles and each of their edges belongs to an even number of them, by places: such a surface
// has an inside. A T-junction leaves it open.
[[nodiscard]] bool is_closed(const TriangleSoup& soup);

// How often a soup goes around a point that is not on it: the sum of its triangles' solid angles as seen from there, in
// parts of 4 pi (A. Jacobson et al., "Robust Inside-Outside Segmentation using Generalized Winding Numbers", 2013). Of
// a closed soup it is a whole number but for rounding, and 0 outside; negative where its polygons face inwards.
[[nodiscard]] double winding_number(const TriangleSoup& soup, const Vec3& point);

// Whether the one body is wholly inside the other one, whose surface is closed (is_closed()), as the two stand.
[[nodiscard]] bool is_inside(const MovingBody& inner, const MovingBody& outer);

}  // namespace peerd::collision
