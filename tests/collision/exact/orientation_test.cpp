#include "collision/exact/orientation.hpp"

#include <gtest/gtest.h>

#include <gmpxx.h>
#include <cmath>
#include <limits>

#include "tests/collision/soups.hpp"

namespace peerd::collision::orientation_test {

// The determinants once more, in rational numbers.
struct Exact {
  mpq_class x, y, z;
  explicit Exact(const Vec3& p) : x(p[0]), y(p[1]), z(p[2]) {}
  Exact(mpq_class a, mpq_class b, mpq_class c) : x(std::move(a)), y(std::move(b)), z(std::move(c)) {}
};
Exact minus(const Exact& a, const Exact& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
mpq_class determinant(const Exact& u, const Exact& v, const Exact& w) {
  return (u.y * v.z - u.z * v.y) * w.x + (u.z * v.x - u.x * v.z) * w.y + (u.x * v.y - u.y * v.x) * w.z;
}
mpq_class volume(const Vec3& a, const Vec3& b, const Vec3& c, const Exact& d) {
  return determinant(minus(Exact(b), Exact(a)), minus(Exact(c), Exact(a)), d);
}
mpq_class part(const Exact& p, int k) { return k == 0 ? p.x : k == 1 ? p.y : p.z; }
mpq_class area(const Exact& u, const Exact& v, int i, int j) {
  return part(u, i) * part(v, j) - part(u, j) * part(v, i);
}

// Four points of which the last is nearly, or exactly, in the plane of the others.
struct Points {
  Vec3 a, b, c, d;
};
Points nearly_flat(Numbers& numbers, int i) {
  const double size = i % 5 == 0 ? 0x1p-1040 : i % 5 == 1 ? 0x1p300 : 1.0;
  Points p{numbers.point(size), numbers.point(size), numbers.point(size), Vec3::Zero()};
  if (i % 3 == 0) p.a = p.a.cast<float>().cast<double>();
  p.d = p.a + numbers.unit() * (p.b - p.a) + numbers.unit() * (p.c - p.a);
  if (i % 7 == 0) p.d = 0.5 * p.a + 0.5 * p.b;
  if (i % 11 == 0) p.d[i % 3] = std::nextafter(p.d[i % 3], 1.0);
  return p;
}

TEST(Orientation, SignsAreThoseOfRationalNumbers) {
  Numbers numbers(201);
  OrientationCounters counters;
  int zeros = 0;
  for (int i = 0; i < 4000; ++i) {
    const Points p = nearly_flat(numbers, i);
    const mpq_class truth = volume(p.a, p.b, p.c, minus(Exact(p.d), Exact(p.a)));
    ASSERT_EQ(volume_sign(p.a, p.b, p.c, p.d, counters), sgn(truth)) << i;
    ASSERT_EQ(volume_sign_exact(p.a, p.b, p.c, p.d, counters), sgn(truth)) << i;
    ASSERT_EQ(volume_sign(p.b, p.a, p.c, p.d, counters), -sgn(truth)) << i;
    const Vec3 direction = p.d - p.a;
    ASSERT_EQ(volume_sign_along(p.a, p.b, p.c, direction, counters), sgn(volume(p.a, p.b, p.c, Exact(direction))));
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3;
      const Exact u = minus(Exact(p.b), Exact(p.a)), v = minus(Exact(p.d), Exact(p.a));
      ASSERT_EQ(orient2d(p.a, p.b, p.d, k, l, counters), sgn(area(u, v, k, l)));
      ASSERT_EQ(orient2d_along(p.a, p.b, direction, k, l, counters), sgn(area(u, Exact(direction), k, l)));
    }
    zeros += truth == 0;
  }
  EXPECT_GT(zeros, 10);
  EXPECT_GT(counters.exact, 1000u);
  EXPECT_GT(counters.wide, 100u);
}

// The filter says nothing rather than something wrong, and mostly says something.
TEST(Orientation, TheFilterIsNeverWrong) {
  Numbers numbers(202);
  int open = 0;
  for (int i = 0; i < 4000; ++i) {
    const Points p = i % 2 == 0 ? nearly_flat(numbers, i)
                                : Points{numbers.point(1), numbers.point(1), numbers.point(1), numbers.point(1)};
    const int sign = PlaneFilter(p.a, p.b, p.c).sign(p.d);
    open += i % 2 == 1 && sign == 0;
    if (sign != 0) {
      ASSERT_EQ(sign, sgn(volume(p.a, p.b, p.c, minus(Exact(p.d), Exact(p.a)))));
    }
  }
  EXPECT_LT(open, 5);
}

// The parameter is the binary64 number nearest to the real one: no neighbour is nearer.
TEST(Orientation, ParametersAreRoundedToNearest) {
  Numbers numbers(203);
  OrientationCounters counters;
  int met = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 a = numbers.point(1), b = numbers.point(1), c = numbers.point(1), origin = numbers.point(2);
    const Vec3 direction = (a + b + c) / 3 - origin;
    if (volume_sign_along(a, b, c, direction, counters) == 0) continue;
    const mpq_class truth = volume(a, b, c, minus(Exact(a), Exact(origin))) / volume(a, b, c, Exact(direction));
    if (truth < 0) continue;
    const double t = plane_parameter(a, b, c, origin, direction, counters);
    const mpq_class off = abs(mpq_class(t) - truth);
    const double up = std::nextafter(t, std::numeric_limits<double>::infinity()), down = std::nextafter(t, -1.0);
    ASSERT_LE(off, abs(mpq_class(up) - truth));
    ASSERT_LE(off, abs(mpq_class(down) - truth));
    ++met;
  }
  EXPECT_GT(met, 2000);
}

TEST(Orientation, ParametersOfLinesAndPoints) {
  OrientationCounters counters;
  EXPECT_EQ(line_parameter({2, -1, 0}, {2, 3, 0}, {0, 0, 0}, {4, 0, 0}, 0, 1, counters), 0.5);
  EXPECT_EQ(point_parameter({7, 0, 0}, {1, 0, 0}, {3, 0, 0}, 0, counters), 2.0);
  EXPECT_EQ(point_parameter({1, 0, 0}, {0, 0, 0}, {3, 0, 0}, 0, counters), 1.0 / 3.0);
}

}  // namespace peerd::collision::orientation_test
