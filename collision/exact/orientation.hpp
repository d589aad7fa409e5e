#pragma once
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/math.hpp"

namespace peerd::collision {

// Signs of determinants of binary64 coordinates: -1, 0 or 1, right for all finite input, subnormal and huge included.
// A floating-point filter with a proven bound answers nearly always; then come the stages of Shewchuk (expansion.hpp
// names the paper), and integers where even those would over- or underflow.

// The work that the filter could not do.
struct OrientationCounters {
  std::uint64_t exact = 0;      // signs that the filter left open
  std::uint64_t wide = 0;       // exact signs beyond the range of expansions
  std::uint64_t quotients = 0;  // parameters that needed integers
};

// Relative rounding error of binary64, 2^-53: Shewchuk's epsilon.
inline constexpr double kUnitRoundoff = 0x1p-53;

static_assert(2.0 * kUnitRoundoff == std::numeric_limits<double>::epsilon());

// The sign of |b - a, c - a, d - a| = ((b - a) x (c - a)) . (d - a): 1 when a b c run counter-clockwise seen from d.
[[nodiscard]] int volume_sign_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                                    OrientationCounters& counters);
// The sign of |b - a, c - a| in the plane of the coordinates i and j: 1 when a b c turn to the left, i to the right and
// j up.
[[nodiscard]] int orient2d_exact(const Vec3& a, const Vec3& b, const Vec3& c, int i, int j,
                                 OrientationCounters& counters);

// The same signs with a direction in place of the last point: of |b - a, c - a, direction| and of |b - a, direction|.
[[nodiscard]] int volume_sign_along_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& direction,
                                          OrientationCounters& counters);
[[nodiscard]] int orient2d_along_exact(const Vec3& a, const Vec3& b, const Vec3& direction, int i, int j,
                                       OrientationCounters& counters);

// The room for underflow [m^3] and [m^2]: each of the few products of a determinant can lose 2^-1075, and what was lost
// is multiplied by at most one more coordinate difference. Far above that, so that it never makes a subnormal number of
// an ordinary difference.
inline constexpr double kUnderflow = 0x1p-960;

// A triangle's normal, and what bounds the rounding of its dot products.
class PlaneFilter {
 public:
  PlaneFilter(const Vec3& a, const Vec3& b, const Vec3& c) : origin_(a) {
    const double ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
    const double vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2];
    set(0, uy * vz, uz * vy);
    set(1, uz * vx, ux * vz);
    set(2, ux * vy, uy * vx);
  }
  // The sign of the volume of a, b, c, d, or 0 where rounding could have changed it. The bound is Shewchuk's of section
  // 4.4, (7 + 56 u) u times the permanent; the eighth u covers the roundings of the permanent itself. With an overflow
  // some number is infinite or none at all, and the comparisons fail.
  [[nodiscard]] int sign(const Vec3& d) const { return sign(d[0] - origin_[0], d[1] - origin_[1], d[2] - origin_[2]); }
  // The sign of the volume of a, b, c, a + direction: there is one rounding less in it.
  [[nodiscard]] int sign_along(const Vec3& direction) const { return sign(direction[0], direction[1], direction[2]); }

 private:
  [[nodiscard]] int sign(double x, double y, double z) const {
    const double value = (normal_[0] * x + normal_[1] * y) + normal_[2] * z;
    const double ax = std::abs(x), ay = std::abs(y), az = std::abs(z);
    const double size = (size_[0] * ax + size_[1] * ay) + size_[2] * az;
    const double bound = 8.0 * kUnitRoundoff * size + (kUnderflow * ((ax + ay) + az) + kUnderflow);
    return (value > bound) - (-value > bound);
  }
  void set(int i, double plus, double minus) {
    normal_[i] = plus - minus;
    size_[i] = std::abs(plus) + std::abs(minus);
  }
  const Vec3& origin_;
  double normal_[3], size_[3];
};

[[nodiscard]] inline int volume_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                                     OrientationCounters& counters) {
  const int sign = PlaneFilter(a, b, c).sign(d);
  return sign != 0 ? sign : volume_sign_exact(a, b, c, d, counters);
}

[[nodiscard]] inline int volume_sign_along(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& direction,
                                           OrientationCounters& counters) {
  const int sign = PlaneFilter(a, b, c).sign_along(direction);
  return sign != 0 ? sign : volume_sign_along_exact(a, b, c, direction, counters);
}

// The bound is that of Shewchuk's section 4.3, (3 + 16 u) u times the permanent.
[[nodiscard]] inline int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, int i, int j,
                                  OrientationCounters& counters) {
  const double plus = (b[i] - a[i]) * (c[j] - a[j]);
  const double minus = (b[j] - a[j]) * (c[i] - a[i]);
  const double value = plus - minus;
  const double bound = 4.0 * kUnitRoundoff * (std::abs(plus) + std::abs(minus)) + kUnderflow;
  if (value > bound) return 1;
  if (-value > bound) return -1;
  return orient2d_exact(a, b, c, i, j, counters);
}

[[nodiscard]] inline int orient2d_along(const Vec3& a, const Vec3& b, const Vec3& direction, int i, int j,
                                        OrientationCounters& counters) {
  const double plus = (b[i] - a[i]) * direction[j];
  const double minus = (b[j] - a[j]) * direction[i];
  const double value = plus - minus;
  const double bound = 4.0 * kUnitRoundoff * (std::abs(plus) + std::abs(minus)) + kUnderflow;
  if (value > bound) return 1;
  if (-value > bound) return -1;
  return orient2d_along_exact(a, b, direction, i, j, counters);
}

// The parameter t at which origin + t * direction meets something, rounded to nearest, ties to even: the binary64
// number that is closest to the real t. Callers know that it is met at some t >= 0, and that the divisor isn't 0.
//
// The plane of a, b, c: |b - a, c - a, a - origin| / |b - a, c - a, direction|.
[[nodiscard]] double plane_parameter(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& origin,
                                     const Vec3& direction, OrientationCounters& counters);
// The line of a, b in the plane of the coordinates i and j: |a - origin, b - origin| / |direction, b - a|.
[[nodiscard]] double line_parameter(const Vec3& a, const Vec3& b, const Vec3& origin, const Vec3& direction, int i,
                                    int j, OrientationCounters& counters);
// A point on the ray: (a - origin) / direction, of the coordinate i.
[[nodiscard]] double point_parameter(const Vec3& a, const Vec3& origin, const Vec3& direction, int i,
                                     OrientationCounters& counters);

}  // namespace peerd::collision
