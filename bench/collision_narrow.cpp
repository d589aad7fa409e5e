#include "collision_narrow.hpp"

#include <algorithm>
#include <cmath>

#include "collision/exact/triangle_touch.hpp"
#include "collision_thesis_test.hpp"

namespace peerd::bench {
namespace {

using collision::Triangle;

template <class Real>
int sign(Real x) {
  return (x > 0) - (x < 0);
}

// Signs as they are rounded. For binary32 the coordinates are rounded here, which is in its time.
template <class Real>
struct RoundedSigns {
  struct Vector {
    Real x, y, z;
  };
  static Vector difference(const Vec3& a, const Vec3& b) {
    return {static_cast<Real>(a[0]) - static_cast<Real>(b[0]), static_cast<Real>(a[1]) - static_cast<Real>(b[1]),
            static_cast<Real>(a[2]) - static_cast<Real>(b[2])};
  }
  static Vector cross(const Vector& u, const Vector& v) {
    return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
  }
  static int side(const Vector& n, const Vector& w) { return sign((n.x * w.x + n.y * w.y) + n.z * w.z); }

  std::array<int, 3> sides(const Triangle& plane, const Triangle& of) const {
    const Vector n = cross(difference(plane[1], plane[0]), difference(plane[2], plane[0]));
    return {side(n, difference(of[0], plane[0])), side(n, difference(of[1], plane[0])),
            side(n, difference(of[2], plane[0]))};
  }
  int volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) const {
    return side(cross(difference(b, a), difference(c, a)), difference(d, a));
  }
  int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, int i, int j) const {
    const auto minus_a = [&](const Vec3& p, int k) { return static_cast<Real>(p[k]) - static_cast<Real>(a[k]); };
    return sign(minus_a(b, i) * minus_a(c, j) - minus_a(b, j) * minus_a(c, i));
  }
};

// The library's filter, and 0 where it is uncertain.
struct FilteredSigns {
  std::array<int, 3> sides(const Triangle& plane, const Triangle& of) const {
    const collision::PlaneFilter filter(plane[0], plane[1], plane[2]);
    return {filter.sign(of[0]), filter.sign(of[1]), filter.sign(of[2])};
  }
  int volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) const {
    return collision::PlaneFilter(a, b, c).sign(d);
  }
  int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, int i, int j) const {
    const double plus = (b[i] - a[i]) * (c[j] - a[j]), minus = (b[j] - a[j]) * (c[i] - a[i]);
    const double bound = 4.0 * collision::kUnitRoundoff * (std::abs(plus) + std::abs(minus)) + collision::kUnderflow;
    return (plus - minus > bound) - (minus - plus > bound);
  }
};

template <class Signs>
bool touch_by(const Triangle& a, const Triangle& b) {
  Signs signs;
  return collision::detail::touch(a, b, signs);
}

bool touch_exactly(const Triangle& a, const Triangle& b) {
  collision::OrientationCounters counters;
  return collision::touch(a, b, counters);
}

}  // namespace

const std::array<Narrow, 5>& narrow_tests() {
  static constexpr std::array<Narrow, 5> kTests = {{{"thesis", thesis_polygons_touch},
                                                    {"float", touch_by<RoundedSigns<float>>},
                                                    {"double", touch_by<RoundedSigns<double>>},
                                                    {"filtered", touch_by<FilteredSigns>},
                                                    {"exact", touch_exactly}}};
  return kTests;
}

}  // namespace peerd::bench
