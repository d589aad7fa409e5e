#pragma once
#include <gmpxx.h>

#include <cstddef>
#include <optional>

#include "collision/exact/moving_triangles.hpp"
#include "collision/exact/ray_triangle.hpp"
#include "collision/exact/triangle.hpp"
#include "tests/oracle/moving_oracle.hpp"
#include "tests/oracle/ray_oracle.hpp"
#include "tests/oracle/triangle_oracle.hpp"

namespace peerd::collision {

// The oracles know nothing of our types: plain() is what they take, ours() what they give.
inline oracle::Point plain(const Vec3& p) { return {p[0], p[1], p[2]}; }
inline oracle::Triangle plain(const Triangle& t) { return {plain(t[0]), plain(t[1]), plain(t[2])}; }
inline Vec3 ours(const oracle::Point& p) { return {p[0], p[1], p[2]}; }
inline Triangle ours(const oracle::Triangle& t) { return {ours(t[0]), ours(t[1]), ours(t[2])}; }

inline oracle::MovingTriangle plain(const MovingTriangle& triangle) {
  oracle::MovingTriangle out{};
  for (std::size_t i = 0; i < 3; ++i) {
    out.at_0[i] = plain(triangle[i].at_0);
    out.at_1[i] = plain(triangle[i].at_1);
  }
  return out;
}

inline std::optional<double> oracle_parameter(const Ray& ray, const Triangle& t) {
  return oracle::first_parameter(plain(ray.origin), plain(ray.direction), plain(t));
}

inline mpq_class squared(double x) { return mpq_class(x) * mpq_class(x); }

}  // namespace peerd::collision
