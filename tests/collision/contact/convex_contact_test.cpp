#include "collision/contact/convex_contact.hpp"

#include <gtest/gtest.h>

#include "tests/collision/shapes.hpp"

namespace peerd::collision::convex_contact_test {

using namespace test;

TEST(RoundingBound, GrowsWithTheMagnitudesOfPositionsVelocitiesAndAccelerations) {
  const KinematicState a = moving({3, -4, 0}, {0, 2, 0}, {0, 0, -9}), b = moving({0, 0, 5}, {-1, 0, 0}, {1, 0, 0});
  const Solid nothing{};
  const RoundingBound e = rounding_bound({nothing, nothing, a, b, 1.0}, 8.0);
  EXPECT_EQ(e.gap_m, kRounding * 20.0);
  EXPECT_EQ(e.speed_m_s, kRounding * 3.0);
  EXPECT_EQ(e.half_acceleration, kRounding * 5.0);
  EXPECT_EQ(e.at(0.0), e.gap_m);
  EXPECT_DOUBLE_EQ(e.at(2.0), kRounding * (20.0 + 2.0 * 3.0 + 4.0 * 5.0));
}

// What the bound is for: the gap of two boxes far out, computed and in exact numbers, differ by less.
TEST(RoundingBound, HoldsForGapsFarOut) {
  std::mt19937_64 rng(221);
  for (int i = 0; i < 200; ++i) {
    const Vec3 p = random_vector(rng, 1e9), q = random_vector(rng, 1e9), n = random_vector(rng, 1.0).normalized();
    const KinematicState a = moving(p), b = moving(q);
    const Solid nothing{};
    const double gap = dot(n, Vec3(p - q));
    long double exact = 0.0L;
    for (int k = 0; k < 3; ++k) exact += static_cast<long double>(n[k]) * (static_cast<long double>(p[k]) - q[k]);
    EXPECT_LT(std::abs(static_cast<double>(static_cast<long double>(gap) - exact)),
              rounding_bound({nothing, nothing, a, b, 1.0}, 0.0).gap_m);
  }
}

}  // namespace peerd::collision::convex_contact_test
