#pragma once
#include "collision/contact/contact.hpp"

namespace peerd {

// How far two bodies are in each other, as they stand.
struct Crossing {
  double depth_m = 0.0;         // 0: they are apart, or one is wholly inside the other
  bool is_lower_bound = false;  // the depth is that of two of their polygons alone
};

// The depth is the least way that one of the two has to go so that their surfaces do not cross any more: out of the
// other, or wholly into it. Of two convex pieces it is the least overlap along their separating-axis candidates, or how
// far the one sticks out of the other where this is less; of a Sphere and polygons its radius less the distance of its
// centre from them. Bodies of several pieces are in each other as far as any two of their pieces are. For other meshes,
// and pieces with many edges, it is collision::touch_depth_m(). Type BOX compares the world boxes. The two have an
// exact answer (collision::has_exact_answer()), but for BOX.
[[nodiscard]] Crossing crossing(const collision::MovingBody& a, const collision::MovingBody& b, CollisionType type);

}  // namespace peerd
