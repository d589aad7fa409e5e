#include "collision/query/wide_motion.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace peerd::collision {

WideMotion::WideMotion(const WideTree& a, const WideTree& b, const RelativeMotion& motion, double margin_m) {
  assert(!std::isnan(margin_m) && a.scale() > 0.0 && b.scale() > 0.0);
  const Vec3 origin = motion(b.origin()) - a.origin();
  const Vec3 home = multiply(Mat3(motion.rotation.transpose()), Vec3(-origin));
  const double to_a = a.scale() / b.scale(), to_b = b.scale() / a.scale();
  scale_a_from_b = static_cast<float>(to_a);
  double farthest = 0.0;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    for (int j = 0; j < 3; ++j) {
      const auto l = static_cast<std::size_t>(j);
      a_from_b[k][l] = static_cast<float>(motion.rotation(i, j) * to_a);
      b_from_a[k][l] = static_cast<float>(motion.rotation(j, i) * to_b);
      a_from_b_64[k][l] = motion.rotation(i, j) * to_a;
      a_from_b_sizes[k][l] = std::abs(a_from_b[k][l]);
      b_from_a_sizes[k][l] = std::abs(b_from_a[k][l]);
    }
    b_in_a[k] = static_cast<float>(origin[i] * a.scale());
    a_in_b[k] = static_cast<float>(home[i] * b.scale());
    b_in_a_64[k] = origin[i] * a.scale();
    farthest = std::max({farthest, std::abs(origin[i]), std::abs(home[i])});
  }
  // Each of some 25 roundings (two more than a corner's own, for corners are kept relative to their leaf's center) is
  // of a number below the sum in brackets (its terms' factors are at most sqrt(3)), by at most 2^-24 of it. The
  // rounding of binary64, in which vertices are moved for the exact test, is far below that, except for vertices far
  // from their soup's origin, which the second term is for.
  const auto far = [](const WideTree& tree) { return tree.origin().cwiseAbs().maxCoeff() + tree.extent_m(); };
  const double binary64 = 0x1p-46 * (far(a) + far(b) + motion.translation.cwiseAbs().maxCoeff());
  const double size_m = 2.0 * a.extent_m() + 2.0 * b.extent_m() + farthest + margin_m;
  const double slack_m = 0x1p-19 * size_m + binary64 + margin_m;
  slack_a = static_cast<float>(slack_m * a.scale() + 0x1p-120);
  slack_b = static_cast<float>(slack_m * b.scale() + 0x1p-120);
  // docs/decisions/collision-margins.md counts the roundings.
  constexpr double kLargest = 0x1p63;
  in_range = to_a == 1.0 && size_m * a.scale() <= kLargest;
  slack_oriented =
      in_range ? static_cast<float>((0x1p-17 * size_m + binary64 + margin_m) * a.scale() + 0x1p-120) : 0.0f;
  rounding_64 = in_range ? static_cast<float>(binary64 * a.scale() + 0x1p-130) : 0.0f;
}

}  // namespace peerd::collision
