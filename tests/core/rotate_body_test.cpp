#include "core/rotate_body.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace peerd::rotate_body_test {

double drawn(std::mt19937_64& rng) { return 2.0 * std::ldexp(static_cast<double>(rng() >> 11), -53) - 1.0; }

TEST(Turned, IsTheProductOfUnitLength) {
  std::mt19937_64 rng(1);
  for (int i = 0; i < 10'000; ++i) {
    const Quat from = Quat(drawn(rng), drawn(rng), drawn(rng), drawn(rng)).normalized();
    const Vec3 by = (i % 2 == 0 ? 0.1 : 10.0) * Vec3(drawn(rng), drawn(rng), drawn(rng));
    const Quat to = rotated_in_body_frame(from, by);
    EXPECT_LT((to.coeffs() - (from * quat_exp(by)).normalized().coeffs()).norm(), 5e-16) << by.transpose();
    EXPECT_NEAR(to.norm(), 1.0, 3e-16);
  }
}

TEST(Turned, IsOfUnitLengthWhateverItBeganWith) {
  const Vec3 by(0.1, -0.2, 0.3);
  for (const double length : {1.0 + 4e-9, 1.0 - 4e-9, 1.0 + 6e-9, 1.0 - 1e-6, 0.5, 3.0}) {
    const Quat to = rotated_in_body_frame(Quat(0.0, length, 0.0, 0.0), by);
    EXPECT_NEAR(to.norm(), 1.0, 3e-16) << length;
    EXPECT_LT((to.coeffs() - rotated_in_body_frame(Quat(0.0, 1.0, 0.0, 0.0), by).coeffs()).norm(), 5e-16) << length;
  }
}

TEST(Turned, ByNothingStaysToTheLastBit) {
  const Quat from(0.5, -0.5, 0.5, 0.5);
  EXPECT_EQ(rotated_in_body_frame(from, Vec3::Zero()).coeffs(), from.coeffs());
}

}  // namespace peerd::rotate_body_test
