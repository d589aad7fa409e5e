#pragma once
#include <gmpxx.h>

#include <optional>

#include "tests/oracle/triangle_oracle.hpp"

namespace peerd::oracle {

// A triangle whose corners move along straight lines at constant speed, from time 0 to time 1.
struct MovingTriangle {
  Triangle at_0, at_1;
};

// Whether they share a point at a rational time. Exact.
[[nodiscard]] bool touch_at(const MovingTriangle& a, const MovingTriangle& b, const mpq_class& time);
// The square of their distance then. Exact.
[[nodiscard]] mpq_class squared_distance_at(const MovingTriangle& a, const MovingTriangle& b, const mpq_class& time);

// The first time in [0, 1] at which two moving triangles share a point. They don't before `not_before`, and they do at
// `at_latest`: both rational, and no more than kTimeBits bits apart. Nothing where they share none in [0, 1].
//
// A touch that begins and ends within 2^-kTimeBits may be missed, unless it is at a time of so few bits.
struct FirstTouch {
  mpq_class not_before, at_latest;
};
inline constexpr int kTimeBits = 64;
[[nodiscard]] std::optional<FirstTouch> first_touch(const MovingTriangle& a, const MovingTriangle& b);

}  // namespace peerd::oracle
