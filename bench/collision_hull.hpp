#pragma once
#include <optional>
#include <span>

#include "core/math.hpp"

namespace peerd::bench {

// The volume [m^3] of the convex hull by Qhull, to check ours with; there is none where the points have no volume.
[[nodiscard]] std::optional<double> qhull_volume(std::span<const Vec3> points);

}  // namespace peerd::bench
