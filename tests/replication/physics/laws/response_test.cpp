#include "replication/physics/laws/response.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::response_test {

using namespace test;

KinematicState answer(ResponseType type, const KinematicState& self, const KinematicState& other, OtherSide other_side,
                      const Vec3& n) {
  CollisionResponse response;
  response.type = type;
  return respond({response, nullptr, other_side, self, other, n});
}
CollisionResponse impulse(double mass_kg, double restitution = 1.0, double friction_m_s2 = 0.0) {
  return {ResponseType::kImpulse, true, mass_kg, restitution, friction_m_s2};
}

struct Case {
  const char* name;
  ResponseType type;
  Vec3 self, other;  // velocities [m/s]; the normal is +x
  OtherSide other_side;
  Vec3 expected;
};
class Respond : public testing::TestWithParam<Case> {};
TEST_P(Respond, ChangesTheVelocity) {
  const auto& [name, type, self, other, other_side, expected] = GetParam();
  KinematicState s = moving({1, 2, 3}, self);
  s.orientation = Quat(0, 1, 0, 0);
  const KinematicState after = answer(type, s, moving({0, 2, 3}, other), other_side, Vec3::UnitX());
  EXPECT_EQ(after.velocity, expected);
  EXPECT_EQ(after.position, s.position);
  EXPECT_EQ(after.orientation.coeffs(), s.orientation.coeffs());
}
constexpr auto kGoesOn = OtherSide::kGoesOn, kAnswers = OtherSide::kAnswers, kAnswersApart = OtherSide::kAnswersApart;
constexpr auto kInverse = ResponseType::kInverse, kZero = ResponseType::kZero;
INSTANTIATE_TEST_SUITE_P(
    Table, Respond,
    testing::Values(Case{"InverseHeadOn", kInverse, {-2, 0, 0}, {0, 0, 0}, kGoesOn, {2, 0, 0}},
                    Case{"InverseKeepsWhatIsAlongThePolygon", kInverse, {-2, 3, -5}, {0, 0, 0}, kGoesOn, {2, 3, -5}},
                    Case{"InverseOfAResting", kInverse, {0, 0, 0}, {4, 0, 0}, kGoesOn, {8, 0, 0}},
                    Case{"InverseIsRelative", kInverse, {-2, 0, 0}, {-1, 7, 0}, kGoesOn, {0, 0, 0}},
                    Case{"InverseOvertaken", kInverse, {1, 0, 0}, {3, 0, 0}, kGoesOn, {5, 0, 0}},
                    Case{"InverseOfWhatParts", kInverse, {3, 1, 0}, {1, 0, 0}, kGoesOn, {3, 1, 0}},
                    Case{"BothInverseHeadOn", kInverse, {-2, 1, 0}, {5, 0, 0}, kAnswers, {2, 1, 0}},
                    Case{"BothInverseOvertaken", kInverse, {1, 1, 0}, {3, 0, 0}, kAnswers, {1, 1, 0}},
                    Case{"BothInverseOvertaking", kInverse, {-3, 0, 0}, {-1, 0, 0}, kAnswers, {3, 0, 0}},
                    Case{"ZeroStops", kZero, {-2, 3, -5}, {0, 0, 0}, kGoesOn, {0, 0, 0}},
                    Case{"ZeroStopsWhateverTheOtherDoes", kZero, {-2, 3, -5}, {9, 9, 9}, kAnswers, {0, 0, 0}}),
    [](const auto& c) { return std::string(c.param.name); });

TEST(Respond, InverseKeepsAccelerationAndSpinAndZeroDoesNot) {
  KinematicState s = moving({0, 0, 0}, {-1, 0, 0}, {0, -9.81, 0});
  s.angular_velocity_body = {1, 2, 3};
  const KinematicState inverse = answer(kInverse, s, {}, kGoesOn, Vec3::UnitX());
  EXPECT_EQ(inverse.acceleration, s.acceleration);
  EXPECT_EQ(inverse.angular_velocity_body, s.angular_velocity_body);
  const KinematicState zero = answer(kZero, s, {}, kGoesOn, Vec3::UnitX());
  EXPECT_EQ(zero.acceleration, Vec3::Zero());
  EXPECT_EQ(zero.angular_velocity_body, Vec3::Zero());
}

Vec3 random_vector(std::mt19937_64& rng) {
  std::uniform_real_distribution<double> u(-10.0, 10.0);
  const double x = u(rng), y = u(rng);
  return {x, y, u(rng)};
}

// Relative to a partner that continues as before, the speed towards it changes its sign and the rest stays, in any
// frame.
TEST(Respond, InverseMirrorsInTheOthersFrame) {
  std::mt19937_64 rng(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 n = random_vector(rng).normalized();
    const KinematicState self = moving(random_vector(rng), random_vector(rng)),
                         other = moving(random_vector(rng), random_vector(rng));
    const KinematicState after = answer(kInverse, self, other, kGoesOn, n);
    const Vec3 was = self.velocity - other.velocity, is = after.velocity - other.velocity;
    EXPECT_NEAR(is.dot(n), std::abs(was.dot(n)), 1e-12);
    EXPECT_LT(((is - is.dot(n) * n) - (was - was.dot(n) * n)).norm(), 1e-12);
  }
}

// ---- impulse ----

struct Struck {
  const char* name;
  CollisionResponse self, other;
  double v_self, v_other;  // along the normal, which faces self [m/s]
  OtherSide other_side;
  double expected;
};
class Impulse : public testing::TestWithParam<Struck> {};
TEST_P(Impulse, ChangesTheVelocityAlongTheNormal) {
  const Struck& c = GetParam();
  const KinematicState self = moving({0, 0, 0}, {c.v_self, 3, -5}, {0, -9.81, 0}),
                       other = moving({-1, 0, 0}, {c.v_other, 7, 0});
  const KinematicState after = respond({c.self, &c.other, c.other_side, self, other, Vec3::UnitX()});
  EXPECT_DOUBLE_EQ(after.velocity.x(), c.expected);
  EXPECT_EQ(after.velocity.tail<2>(), self.velocity.tail<2>());
  EXPECT_EQ(after.acceleration, self.acceleration);
}
INSTANTIATE_TEST_SUITE_P(
    Table, Impulse,
    testing::Values(Struck{"EqualMassesExchange", impulse(1), impulse(1), -2, 0, kAnswers, 0},
                    Struck{"TheOneThatIsHitTakesIt", impulse(1), impulse(1), 0, 2, kAnswers, 2},
                    Struck{"HeavyOneGoesOn", impulse(3), impulse(1), -2, 0, kAnswers, -1},
                    Struck{"LightOneIsThrownBack", impulse(1), impulse(3), -2, 0, kAnswers, 1},
                    Struck{"PlasticGoTogether", impulse(1, 0), impulse(1, 0), -2, 0, kAnswers, -1},
                    Struck{"TheSmallerRestitutionCounts", impulse(1, 0.9), impulse(1, 0.5), -2, 0, kAnswers, -0.5},
                    Struck{"AWallIsOfInfiniteMass", impulse(1, 0.75), impulse(1), -4, 0, kGoesOn, 3},
                    Struck{"AWallsRestitutionCounts", impulse(1, 0.9), impulse(1, 0.5), -4, 0, kGoesOn, 2},
                    Struck{"AnotherResponsesDoesNot", impulse(1, 0.75), CollisionResponse{}, -4, 0, kAnswers, 3},
                    Struck{"WhatAnswersApartIsAWallThatStands", impulse(1), impulse(3), -2, 4, kAnswersApart, 2},
                    Struck{"ARacketThatComesAddsSpeed", impulse(1, 0.5), impulse(1), -10, 4, kGoesOn, 11},
                    Struck{"WhatPartsKeepsItsSpeed", impulse(1, 0.5), impulse(1), 3, 1, kAnswers, 3}),
    [](const auto& c) { return std::string(c.param.name); });

// Newton's law of restitution and the conservation laws hold for any two bodies.
TEST(Respond, ImpulseKeepsMomentumAndPartsByRestitution) {
  std::mt19937_64 rng(3);
  for (int i = 0; i < 1000; ++i) {
    const auto unit = [&] { return static_cast<double>(rng() >> 11) * 0x1p-53; };
    const CollisionResponse of_a = impulse(0.1 + unit(), unit()), of_b = impulse(0.1 + 10.0 * unit(), unit());
    const Vec3 n = random_vector(rng).normalized();
    const KinematicState a = moving({0, 0, 0}, random_vector(rng)), b = moving({0, 0, 0}, random_vector(rng));
    const KinematicState after_a = respond({of_a, &of_b, OtherSide::kAnswers, a, b, n}),
                         after_b = respond({of_b, &of_a, OtherSide::kAnswers, b, a, -n});
    const auto momentum = [&](const KinematicState& p, const KinematicState& q) {
      return Vec3(of_a.mass_kg * p.velocity + of_b.mass_kg * q.velocity);
    };
    EXPECT_LT((momentum(a, b) - momentum(after_a, after_b)).norm(), 1e-12);
    const double approach = n.dot(b.velocity - a.velocity), part = n.dot(after_a.velocity - after_b.velocity);
    const double e = std::min(of_a.restitution, of_b.restitution);
    EXPECT_NEAR(part, approach > 0.0 ? e * approach : -approach, 1e-12);
  }
}

// Whatever two respond by, they part, and hold no more energy than before.
TEST(Respond, NoTwoResponsesAddEnergy) {
  std::mt19937_64 rng(4);
  const auto unit = [&] { return static_cast<double>(rng() >> 11) * 0x1p-53; };
  int mixed = 0;
  for (int i = 0; i < 10'000; ++i) {
    const auto some_response = [&] {
      CollisionResponse response = impulse(std::pow(10.0, 5.0 * unit()), unit());
      response.type = std::array{ResponseType::kInverse, ResponseType::kZero, ResponseType::kImpulse}[rng() % 3];
      return response;
    };
    const CollisionResponse of_a = some_response(), of_b = some_response();
    const Vec3 n = random_vector(rng).normalized();
    const KinematicState a = moving({0, 0, 0}, random_vector(rng)), b = moving({0, 0, 0}, random_vector(rng));
    if (n.dot(a.velocity - b.velocity) >= 0.0) continue;
    mixed += of_a.type != of_b.type ? 1 : 0;
    const KinematicState after_a = respond({of_a, &of_b, OtherSide::kAnswers, a, b, n}),
                         after_b = respond({of_b, &of_a, OtherSide::kAnswers, b, a, -n});
    const auto energy = [&](const KinematicState& p, const KinematicState& q) {
      return of_a.mass_kg * p.velocity.squaredNorm() + of_b.mass_kg * q.velocity.squaredNorm();
    };
    EXPECT_LE(energy(after_a, after_b), energy(a, b) * (1.0 + 1e-12));
    EXPECT_GE(n.dot(after_a.velocity - after_b.velocity), -1e-12);
  }
  EXPECT_GT(mixed, 1000);
}

// At 10 m/s^2, 2^-10 s of flight take 4.9 mm/s.
TEST(ComesToRest, IsAShortFlight) {
  EXPECT_TRUE(comes_to_rest(0.0, -10.0));
  EXPECT_TRUE(comes_to_rest(0.0048, -10.0));
  EXPECT_FALSE(comes_to_rest(0.0049, -10.0));
  EXPECT_FALSE(comes_to_rest(0.0, 0.0)) << "nothing brings the two together again";
  EXPECT_FALSE(comes_to_rest(0.0, 10.0));
}

// ---- friction ----

TEST(LawAfter, SlidesWhereNothingElseAccelerates) {
  const CollisionResponse rough = impulse(1, 1, 0.5);
  const KinematicState state = moving({1, 2, 3}, {3, 0, 4});
  const MotionModel slides = law_after(&rough, KinematicState{}, state);
  EXPECT_EQ(slides.kind, MotionKind::kSliding);
  EXPECT_LT((slides.state.acceleration - Vec3(-0.3, 0, -0.4)).norm(), 1e-15);
  EXPECT_EQ(evaluate(slides, 10.0).velocity, Vec3::Zero());
  EXPECT_LT((evaluate(slides, 20.0).position - Vec3(16, 2, 23)).norm(), 1e-12) << "v^2 / 2a = 25 m";

  const KinematicState flies = moving({1, 2, 3}, {3, 0, 4}, {0, -9.81, 0});
  EXPECT_EQ(law_after(&rough, flies, flies).kind, MotionKind::kSecond);
  const CollisionResponse smooth = impulse(1);
  EXPECT_EQ(law_after(&smooth, KinematicState{}, state).kind, MotionKind::kSecond);
  EXPECT_EQ(law_after(nullptr, KinematicState{}, state).kind, MotionKind::kSecond);
}

TEST(LawAfter, KeepsADecelerationThatTheWorldDoesNotName) {
  const CollisionResponse smooth = impulse(1);
  const MotionModel law = sliding_to_rest(moving({0, 0, 0}, {2, 0, 0}), 0.25);
  KinematicState after = law.state;
  after.velocity = {0, 0, 4};
  const MotionModel now = law_after(&smooth, law, after);
  EXPECT_EQ(now.kind, MotionKind::kSliding);
  EXPECT_EQ(now.state.acceleration, Vec3(0, 0, -0.25));
}

TEST(LawOfOutcome, TellsFrictionFromGravity) {
  const CollisionResponse rough = impulse(1, 1, 0.3);
  const MotionModel slides = sliding_to_rest(moving({0, 0, 0}, {1, 2, 3}), 0.3);
  EXPECT_EQ(law_of_outcome(&rough, slides.state).kind, MotionKind::kSliding);
  EXPECT_EQ(law_of_outcome(&rough, moving({0, 0, 0}, {1, 2, 3}, {0, -9.81, 0})).kind, MotionKind::kSecond);
  EXPECT_EQ(law_of_outcome(nullptr, slides.state).kind, MotionKind::kSecond);
}

}  // namespace peerd::replication::response_test
