#pragma once
#include <optional>
#include <span>
#include <vector>

#include "core/math.hpp"

namespace peerd::bench {

struct Hull {
  std::vector<Vec3> vertices;  // corners
  double volume_m3 = 0;
};
// The hull is Qhull's; there is none where the points have no volume.
[[nodiscard]] std::optional<Hull> convex_hull(std::span<const Vec3> points);

// The volume is that of a box that holds the points: the box is along their principal axes, then a seeded search turns
// it for as long as that makes it smaller.
[[nodiscard]] double oriented_box_volume(std::span<const Vec3> points);

// The volume is that of a ball that holds the points, by Badoiu and Clarkson, "Smaller Core-Sets for Balls", SODA 2003;
// its radius is within a thousandth of the least.
[[nodiscard]] double ball_volume(std::span<const Vec3> points);

}  // namespace peerd::bench
