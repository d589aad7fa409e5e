#include "replication/wire/smallest_three.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "replication/wire/record.hpp"
#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::smallest_three_test {

bool same_bits(const Quat& a, const Quat& b) {
  return test::same_bits(at_rest({Vec3::Zero(), a}), at_rest({Vec3::Zero(), b}));
}

class Draw {
 public:
  double operator()() { return std::ldexp(static_cast<double>(rng_() >> 11), -52) - 1.0; }
  Quat orientation() { return Quat((*this)(), (*this)(), (*this)(), (*this)() + 1e-9).normalized(); }

 private:
  std::mt19937_64 rng_{1};
};

void expect_close(const Quat& q) {
  const SmallestThree three = smallest_three(q);
  const auto rounded = to_orientation(three);
  ASSERT_TRUE(rounded);
  EXPECT_LE(angle_between(q, *rounded), kOrientationError_rad);
  EXPECT_NEAR(rounded->norm(), 1.0, 1e-15);
  const auto again = to_orientation(smallest_three(*rounded));
  ASSERT_TRUE(again);
  EXPECT_TRUE(same_bits(*again, *rounded));
}

TEST(SmallestThree, IsCloseAndUnitAndRoundsOnce) {
  Draw draw;
  for (int i = 0; i < 100000; ++i) {
    ASSERT_NO_FATAL_FAILURE(expect_close(draw.orientation()));
    if (HasFailure()) return;
  }
}

// Where two, three or all four components are about the largest, rounding may exchange them.
TEST(SmallestThree, RoundsOnceWhereTheLargestAreAlmostEqual) {
  Draw draw;
  for (int i = 0; i < 100000; ++i) {
    const double a = 1.0 + 1e-4 * draw(), b = 1.0 + 1e-4 * draw(), c = i % 3 == 0 ? draw() : 1.0 + 1e-4 * draw();
    const double d = i % 2 == 0 ? draw() : -1.0 + 1e-4 * draw();
    ASSERT_NO_FATAL_FAILURE(expect_close(Quat(a, b, c, d).normalized()));
    ASSERT_NO_FATAL_FAILURE(expect_close(Quat(d, -c, b, a).normalized()));
    if (HasFailure()) return;
  }
}

TEST(SmallestThree, HasHalfTurnsAndTheIdentityExactly) {
  for (const Quat& q : {Quat(1, 0, 0, 0), Quat(0, 1, 0, 0), Quat(0, 0, 1, 0), Quat(0, 0, 0, 1)}) {
    EXPECT_TRUE(same_bits(to_orientation(smallest_three(q)).value(), q));
    EXPECT_TRUE(same_bits(to_orientation(smallest_three(Quat(-q.coeffs()))).value(), q));
  }
  Draw draw;
  for (int i = 0; i < 20000; ++i) {
    ASSERT_NO_FATAL_FAILURE(expect_close(Quat(0, draw(), draw(), draw() + 1e-9).normalized()));
  }
}

// The bound is as tight as stated.
TEST(SmallestThree, ErrsAsMuchAsItsBoundAllows) {
  Draw draw;
  double worst = 0.0;
  for (int i = 0; i < 200000; ++i) {
    const Quat q = Quat(1 + 0.01 * draw(), 1 + 0.01 * draw(), 1 + 0.01 * draw(), 1.02).normalized();
    worst = std::max(worst, angle_between(q, to_orientation(smallest_three(q)).value()));
  }
  EXPECT_GT(worst, 0.8 * kOrientationError_rad);
  EXPECT_LT(kOrientationError_rad, 0.05 * std::numbers::pi / 180.0);
}

TEST(SmallestThree, RefusesMoreThanAUnit) {
  EXPECT_TRUE(to_orientation({0, {SmallestThree::kMost, SmallestThree::kMost, 0}}));
  EXPECT_FALSE(to_orientation({0, {SmallestThree::kMost, SmallestThree::kMost, 1}}));
}

}  // namespace peerd::replication::smallest_three_test
