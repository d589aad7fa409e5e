#pragma once
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/box.hpp"

namespace peerd::collision {

// A box that holds an object's for a while, in binary32 rounded outwards [m]: half the memory to walk through. It only
// culls. The box none() is all NaN, which no comparison finds to overlap anything (the empty box of AxisBox won't do:
// its +inf isn't above the +inf of an infinite box).
struct FatBox {
  std::array<float, 3> lo, hi;

  static FatBox none() {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    return {{nan, nan, nan}, {nan, nan, nan}};
  }
  [[nodiscard]] bool is_none() const { return std::isnan(lo[0]); }
  friend bool operator==(const FatBox&, const FatBox&) = default;
};

static_assert(sizeof(FatBox) == 24);  // half of an exact box: trees walk through these

// The test has no branches: a predictor could not tell which of the six comparisons decides.
[[nodiscard]] inline bool overlap(const FatBox& a, const FatBox& b) {
  return (a.lo[0] <= b.hi[0]) & (b.lo[0] <= a.hi[0]) & (a.lo[1] <= b.hi[1]) & (b.lo[1] <= a.hi[1]) &
         (a.lo[2] <= b.hi[2]) & (b.lo[2] <= a.hi[2]);
}
[[nodiscard]] inline FatBox merged(const FatBox& a, const FatBox& b) {
  FatBox out;
  for (std::size_t i = 0; i < 3; ++i) {
    out.lo[i] = std::min(a.lo[i], b.lo[i]);
    out.hi[i] = std::max(a.hi[i], b.hi[i]);
  }
  return out;
}

// An exact box as it is kept; none() is all NaN here, too.
struct ExactBox {
  std::array<double, 3> lo, hi;

  static ExactBox none() {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    return {{nan, nan, nan}, {nan, nan, nan}};
  }
  static ExactBox of(const WorldBox& box) {
    if (box.is_empty()) return none();
    return {{box.lo[0], box.lo[1], box.lo[2]}, {box.hi[0], box.hi[1], box.hi[2]}};
  }
  [[nodiscard]] bool is_none() const { return std::isnan(lo[0]); }
  friend bool operator==(const ExactBox&, const ExactBox&) = default;
};
[[nodiscard]] inline bool overlap(const ExactBox& a, const ExactBox& b) {
  return (a.lo[0] <= b.hi[0]) & (b.lo[0] <= a.hi[0]) & (a.lo[1] <= b.hi[1]) & (b.lo[1] <= a.hi[1]) &
         (a.lo[2] <= b.hi[2]) & (b.lo[2] <= a.hi[2]);
}
[[nodiscard]] inline bool contains(const FatBox& fat, const ExactBox& box) {
  return (fat.lo[0] <= box.lo[0]) & (box.hi[0] <= fat.hi[0]) & (fat.lo[1] <= box.lo[1]) & (box.hi[1] <= fat.hi[1]) &
         (fat.lo[2] <= box.lo[2]) & (box.hi[2] <= fat.hi[2]);
}

// The margin for all sides of a box whose own sides move by `step_m` a tick [m]. It is never more than twice the
// largest side: something that jumped need not jump on, and a bullet's box is then renewed each tick.
[[nodiscard]] inline double fat_margin_m(const ExactBox& box, double step_m) {
  // With fewer steps more boxes are renewed; with more, more pairs are near that don't overlap.
  // docs/decisions/collision-broad-phase.md has figures.
  constexpr double kSteps = 12.0, kSides = 2.0;
  double side_m = 0.0;
  for (std::size_t i = 0; i < 3; ++i) side_m = std::max(side_m, box.hi[i] - box.lo[i]);  // keeps side_m if that is NaN
  assert(!(step_m < 0.0) && side_m >= 0.0);
  const double margin_m = std::min(kSteps * step_m, kSides * side_m);
  return std::isfinite(margin_m) ? margin_m : 0.0;
}
[[nodiscard]] inline FatBox fattened(const ExactBox& box, double margin_m) {
  if (box.is_none()) return FatBox::none();
  assert(margin_m >= 0.0);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  FatBox out;
  for (std::size_t i = 0; i < 3; ++i) {
    const double lo = box.lo[i] - margin_m, hi = box.hi[i] + margin_m;
    out.lo[i] = static_cast<float>(lo);
    out.hi[i] = static_cast<float>(hi);
    if (out.lo[i] > lo) out.lo[i] = std::nextafter(out.lo[i], -infinity);
    if (out.hi[i] < hi) out.hi[i] = std::nextafter(out.hi[i], infinity);
  }
  assert(contains(out, box));
  return out;
}

}  // namespace peerd::collision
