#include "replication/response.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/replication/worlds.hpp"

namespace peerd::replication {
namespace {

using namespace test;

struct Case {
  const char* name;
  ResponseType type;
  Vec3 self, other;  // velocities [m/s]; the normal is +x
  bool other_answers;
  Vec3 expected;
};
class Respond : public testing::TestWithParam<Case> {};
TEST_P(Respond, ChangesTheVelocity) {
  const auto& [name, type, self, other, other_answers, expected] = GetParam();
  KinematicState s = moving({1, 2, 3}, self);
  s.orientation = Quat(0, 1, 0, 0);
  const KinematicState after = respond(type, s, moving({0, 2, 3}, other), other_answers, Vec3::UnitX());
  EXPECT_EQ(after.velocity, expected);
  EXPECT_EQ(after.position, s.position);
  EXPECT_EQ(after.orientation.coeffs(), s.orientation.coeffs());
}
constexpr auto kInverse = ResponseType::kInverse, kZero = ResponseType::kZero;
INSTANTIATE_TEST_SUITE_P(
    Table, Respond,
    testing::Values(Case{"InverseHeadOn", kInverse, {-2, 0, 0}, {0, 0, 0}, false, {2, 0, 0}},
                    Case{"InverseKeepsWhatIsAlongThePolygon", kInverse, {-2, 3, -5}, {0, 0, 0}, false, {2, 3, -5}},
                    Case{"InverseOfAResting", kInverse, {0, 0, 0}, {4, 0, 0}, false, {8, 0, 0}},
                    Case{"InverseIsRelative", kInverse, {-2, 0, 0}, {-1, 7, 0}, false, {0, 0, 0}},
                    Case{"InverseOvertaken", kInverse, {1, 0, 0}, {3, 0, 0}, false, {5, 0, 0}},
                    Case{"InverseOfWhatParts", kInverse, {3, 1, 0}, {1, 0, 0}, false, {3, 1, 0}},
                    Case{"BothInverseHeadOn", kInverse, {-2, 1, 0}, {5, 0, 0}, true, {2, 1, 0}},
                    Case{"BothInverseOvertaken", kInverse, {1, 1, 0}, {3, 0, 0}, true, {1, 1, 0}},
                    Case{"BothInverseOvertaking", kInverse, {-3, 0, 0}, {-1, 0, 0}, true, {3, 0, 0}},
                    Case{"ZeroStops", kZero, {-2, 3, -5}, {0, 0, 0}, false, {0, 0, 0}},
                    Case{"ZeroStopsWhateverTheOtherDoes", kZero, {-2, 3, -5}, {9, 9, 9}, true, {0, 0, 0}}),
    [](const auto& c) { return std::string(c.param.name); });

TEST(Respond, InverseKeepsAccelerationAndSpinAndZeroDoesNot) {
  KinematicState s = moving({0, 0, 0}, {-1, 0, 0}, {0, -9.81, 0});
  s.angular_velocity_body = {1, 2, 3};
  const KinematicState inverse = respond(kInverse, s, {}, false, Vec3::UnitX());
  EXPECT_EQ(inverse.acceleration, s.acceleration);
  EXPECT_EQ(inverse.angular_velocity_body, s.angular_velocity_body);
  const KinematicState zero = respond(kZero, s, {}, false, Vec3::UnitX());
  EXPECT_EQ(zero.acceleration, Vec3::Zero());
  EXPECT_EQ(zero.angular_velocity_body, Vec3::Zero());
}

Vec3 random_vector(std::mt19937_64& rng) {
  std::uniform_real_distribution<double> u(-10.0, 10.0);
  const double x = u(rng), y = u(rng);
  return {x, y, u(rng)};
}

// Seen from an other that goes on as it did, the speed towards it turns its sign and the rest stays: in any frame.
TEST(Respond, InverseMirrorsInTheOthersFrame) {
  std::mt19937_64 rng(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 n = random_vector(rng).normalized();
    const KinematicState self = moving(random_vector(rng), random_vector(rng)),
                         other = moving(random_vector(rng), random_vector(rng));
    const KinematicState after = respond(kInverse, self, other, false, n);
    const Vec3 was = self.velocity - other.velocity, is = after.velocity - other.velocity;
    EXPECT_NEAR(is.dot(n), std::abs(was.dot(n)), 1e-12);
    EXPECT_LT(((is - is.dot(n) * n) - (was - was.dot(n) * n)).norm(), 1e-12);
  }
}

// Two that both answer part, and neither is faster than it was: or a few that bounce off each other would explode.
TEST(Respond, TwoThatBothInvertPartAndGainNothing) {
  std::mt19937_64 rng(2);
  int approaching = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 n = random_vector(rng).normalized();
    const KinematicState a = moving({0, 0, 0}, random_vector(rng)), b = moving({0, 0, 0}, random_vector(rng));
    if (n.dot(a.velocity - b.velocity) >= 0.0) continue;
    ++approaching;
    const KinematicState after_a = respond(kInverse, a, b, true, n), after_b = respond(kInverse, b, a, true, -n);
    EXPECT_GT(n.dot(after_a.velocity - after_b.velocity), 0.0);
    EXPECT_NEAR(after_a.velocity.norm(), a.velocity.norm(), 1e-12);
    EXPECT_NEAR(after_b.velocity.norm(), b.velocity.norm(), 1e-12);
  }
  EXPECT_GT(approaching, 300);
}

TEST(RestAgainst, TakesOutWhatApproachesOnly) {
  const KinematicState floor = moving({0, 0, 0}, {0, 1, 0}, {0, 2, 0});
  const KinematicState falling = moving({0, 1, 0}, {3, -4, 5}, {1, -9.81, 0});
  const KinematicState rest = rest_against(falling, floor, Vec3::UnitY());
  EXPECT_EQ(rest.velocity, Vec3(3, 1, 5));
  EXPECT_EQ(rest.acceleration, Vec3(1, 2, 0));
  const KinematicState rising = moving({0, 1, 0}, {3, 4, 5}, {1, 9, 0});
  EXPECT_TRUE(same_bits(rest_against(rising, floor, Vec3::UnitY()), rising));
}

}  // namespace
}  // namespace peerd::replication
