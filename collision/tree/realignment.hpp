#pragma once
#include <array>
#include <cstdint>

#include "collision/exact/relative_motion.hpp"
#include "collision/tree/kdop.hpp"

namespace peerd::collision {

// Takes k-DOPs of one frame to k-DOPs of another that contain them, turned and moved as they are.
//
// Along a direction d of the new frame, what lies below the old slabs n_i . p <= h_i lies below sum c_i h_i wherever
// d = sum c_i n_i with c_i >= 0 (the dual of the linear program for the bound). The c_i are found once for each pair of
// frames: those of the three n_i whose cone holds d, so a node costs three multiplications a slab side and no vertices.
template <int K>
class Realignment {
 public:
  // `extent_m`: no coordinate of anything in the old frame is larger.
  Realignment(const RelativeMotion& new_from_old, double extent_m);

  // Contains every vertex of the old k-DOP as new_from_old(vertex) rounds it.
  [[nodiscard]] WideKdop<K> operator()(const Kdop<K>& old) const {
    WideKdop<K> out;
    for (std::size_t i = 0; i < out.kSlabs; ++i) {
      double lo = offset_[i] - pad_[i], hi = offset_[i] + pad_[i];
      for (const Term& term : terms_[i]) {
        const double low = old.lo[term.slab], high = old.hi[term.slab];
        lo += term.weight * (term.weight >= 0.0 ? low : high);
        hi += term.weight * (term.weight >= 0.0 ? high : low);
      }
      out.lo[i] = lo;
      out.hi[i] = hi;
    }
    return out;
  }

 private:
  struct Term {
    double weight = 0.0;  // negative: the slab's opposite direction counts
    std::uint32_t slab = 0;
  };
  std::array<std::array<Term, 3>, K / 2> terms_;
  std::array<double, K / 2> offset_, pad_;  // [m], times the direction's length
};

extern template class Realignment<6>;
extern template class Realignment<14>;
extern template class Realignment<18>;
extern template class Realignment<26>;

}  // namespace peerd::collision
