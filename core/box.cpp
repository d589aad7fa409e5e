#include "core/box.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace peerd {

// Along axis i, with a_j = m_ij and p_j in [lo_j, hi_j] (after Arvo, "Transforming axis-aligned bounding boxes",
// Graphics Gems, 1990):  min = ((min(a_0 lo_0, a_0 hi_0) + min(a_1 lo_1, a_1 hi_1)) + min(a_2 lo_2, a_2 hi_2)) + o_i.
// The sum has multiply()'s order and rounding is monotone, so this already bounds what multiply() gives for any p. The
// reals differ from that by at most g s, where s = |a_0 p_0| + |a_1 p_1| + |a_2 p_2| + |o_i| at its largest and
// g = 4u / (1 - 4u), u = 2^-53: no term goes through more than one product and three sums (Higham, Accuracy and
// Stability of Numerical Algorithms, 2nd ed., lemma 3.1). s itself comes out at least (1 - g) s, and taking the padding
// off rounds by u s more: 5u and terms of u^2, which 8u covers. Products that underflow lose 2^-1075 each, which the
// least normal number covers.
WorldBox transformed(const Affine& m, const LocalBox& box) {
  WorldBox out;
  if (box.is_empty()) return out;
  assert(box.lo.allFinite() && box.hi.allFinite());
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kRounding = 0x1p-50;  // 8u
  constexpr double kUnderflow = std::numeric_limits<double>::min();
  const Vec3 lo = box.lo.cast<double>();
  const Vec3 hi = box.hi.cast<double>();
  const Vec3 farthest = lo.cwiseAbs().cwiseMax(hi.cwiseAbs());
  for (int i = 0; i < 3; ++i) {
    double least[3], most[3], size[3];
    for (int j = 0; j < 3; ++j) {
      const double a = m.linear(i, j);
      least[j] = std::min(a * lo[j], a * hi[j]);
      most[j] = std::max(a * lo[j], a * hi[j]);
      size[j] = std::abs(a) * farthest[j];
    }
    const double o = m.offset[i];
    const double padding = (((size[0] + size[1]) + size[2]) + std::abs(o)) * kRounding + kUnderflow;
    const bool finite = padding < kInfinity;  // false of NaN
    out.lo[i] = finite ? (((least[0] + least[1]) + least[2]) + o) - padding : -kInfinity;
    out.hi[i] = finite ? (((most[0] + most[1]) + most[2]) + o) + padding : kInfinity;
  }
  return out;
}

}  // namespace peerd
