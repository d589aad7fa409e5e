#include "collision/exact/ray_triangle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/collision/oracle_types.hpp"
#include "tests/collision/soups.hpp"

namespace peerd::collision::ray_triangle_test {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Numbers of few bits, so that lines meet, planes contain and edges are parallel to axes often.
double coarse(Numbers& numbers) { return std::floor(numbers.between(-3.0, 4.0)) * 0.5; }
Vec3 coarse_point(Numbers& numbers) {
  const double x = coarse(numbers), y = coarse(numbers), z = coarse(numbers);
  return {x, y, z};
}

struct Tally {
  int hits = 0, misses = 0, at_origin = 0, degenerate = 0;
};
void expect_as_the_oracle(const Ray& ray, const Triangle& t, Tally& tally) {
  OrientationCounters counters;
  const auto found = first_parameter(ray, t, counters), expected = oracle_parameter(ray, t);
  ASSERT_EQ(found.has_value(), expected.has_value());
  if (found) {
    EXPECT_EQ(*found, *expected);
  }
  ++(found ? tally.hits : tally.misses);
  if (found && *found == 0.0) ++tally.at_origin;
}

TEST(RayTriangle, SmallNumbersAreAsTheOracleSays) {
  Numbers numbers(101);
  Tally tally;
  for (int i = 0; i < 20000; ++i) {
    const Triangle t = {coarse_point(numbers), coarse_point(numbers), coarse_point(numbers)};
    const Ray ray{coarse_point(numbers), coarse_point(numbers)};
    if (ray.direction == Vec3::Zero()) continue;
    expect_as_the_oracle(ray, t, tally);
  }
  EXPECT_GT(tally.hits, 1000);
  EXPECT_GT(tally.misses, 1000);
  EXPECT_GT(tally.at_origin, 100);
}

// The ray and the triangle are in one plane and on one line, in all positions.
TEST(RayTriangle, FlatCasesAreAsTheOracleSays) {
  Numbers numbers(102);
  Tally tally;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 u = coarse_point(numbers), v = coarse_point(numbers), at = coarse_point(numbers);
    const bool line = i % 3 == 0;
    const auto somewhere = [&] { return Vec3(at + coarse(numbers) * u + (line ? 0.0 : coarse(numbers)) * v); };
    Triangle t = {somewhere(), somewhere(), somewhere()};
    if (i % 5 == 0) t[1] = t[0];
    if (i % 10 == 0) t[2] = t[0];
    const Vec3 origin = somewhere();
    const Ray ray{origin, somewhere() - origin};
    if (ray.direction == Vec3::Zero()) continue;
    expect_as_the_oracle(ray, t, tally);
  }
  EXPECT_GT(tally.hits, 4000);
  EXPECT_GT(tally.misses, 2000);
}

// The ray goes through a rounded point of a triangle's border: a hair beside it, to either side, or on it.
TEST(RayTriangle, HairsBreadthsAreAsTheOracleSays) {
  Numbers numbers(103);
  Tally tally;
  for (int i = 0; i < 6000; ++i) {
    const Triangle t = {numbers.point(1.0), numbers.point(1.0), numbers.point(1.0)};
    const double w = i % 4 == 0 ? 0.0 : numbers.unit();
    const Vec3 target = t[0] + w * (t[1] - t[0]);
    Ray ray{numbers.point(2.0), Vec3::Zero()};
    ray.direction = target - ray.origin;
    if (i % 2 == 0) {  // a step beyond, of that accuracy
      ray.direction[i % 3] = std::nextafter(ray.direction[i % 3], i % 8 < 4 ? 9.0 : -9.0);
    }
    if (i % 7 == 0) ray.origin = target;                                     // from there
    if (i % 11 == 0) ray.direction = (t[1] - t[0]) + 1e-17 * (t[2] - t[0]);  // nearly along
    expect_as_the_oracle(ray, t, tally);
  }
  EXPECT_GT(tally.hits, 1000);
  EXPECT_GT(tally.misses, 1000);
}

TEST(RayTriangle, AnySizeIsAsTheOracleSays) {
  Numbers numbers(104);
  Tally tally;
  for (int i = 0; i < 4000; ++i) {
    const auto power = [&](double least, double most) { return std::exp2(std::floor(numbers.between(least, most))); };
    const double size = power(-1060.0, 128.0), step = power(-499.0, 499.0);
    const auto place = [&]() -> Vec3 { return (i % 2 == 0 ? coarse_point(numbers) : numbers.point(1.0)) * size; };
    const Triangle t = {place(), place(), place()};
    const Vec3 origin = place();
    Vec3 towards = t[0] / size * 0.5 + t[1] / size * 0.25 + t[2] / size * 0.25 - origin / size;
    if (i % 3 == 0) towards = coarse_point(numbers);
    if (towards == Vec3::Zero()) continue;
    expect_as_the_oracle({origin, towards * step}, t, tally);
  }
  EXPECT_GT(tally.hits, 500);
  EXPECT_GT(tally.misses, 500);
}

TEST(RayTriangle, RefusesWhatIsNoRay) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Vec3 o(1, 2, 3), d(0, 0, 1);
  EXPECT_TRUE(is_usable({o, d}));
  EXPECT_TRUE(is_usable({o, d, 0.0}));
  EXPECT_FALSE(is_usable({o, Vec3::Zero()}));
  EXPECT_FALSE(is_usable({o, d * 0x1p-501}));
  EXPECT_FALSE(is_usable({o, d * 0x1p501}));
  EXPECT_FALSE(is_usable({o * 0x1p130, d}));
  EXPECT_FALSE(is_usable({o, d, -1.0}));
  EXPECT_FALSE(is_usable({o, d, nan}));
  for (const double bad : {nan, kInfinity, -kInfinity}) {
    for (int k = 0; k < 3; ++k) {
      Vec3 p = o, q = d;
      p[k] = q[k] = bad;
      EXPECT_FALSE(is_usable({p, d}));
      EXPECT_FALSE(is_usable({o, q}));
    }
  }
}

}  // namespace peerd::collision::ray_triangle_test
