#include "replication/motion/response.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/replication/worlds.hpp"

namespace peerd::replication::response_test {

using namespace test;

KinematicState answer(ResponseType type, const KinematicState& self, const KinematicState& other, bool other_responds,
                      const Vec3& n) {
  CollisionResponse response;
  response.type = type;
  return respond({response, nullptr, other_responds, self, other, n});
}
KinematicState rested(const CollisionResponse& response, const KinematicState& self, const KinematicState& other,
                      const CollisionResponse* other_response = nullptr) {
  return come_to_rest_against({response, other_response, other_response != nullptr, self, other, Vec3::UnitY()});
}
CollisionResponse impulse(double mass_kg, double restitution = 1.0, double friction_m_s2 = 0.0) {
  return {ResponseType::kImpulse, true, mass_kg, restitution, friction_m_s2};
}

struct Case {
  const char* name;
  ResponseType type;
  Vec3 self, other;  // velocities [m/s]; the normal is +x
  bool other_responds;
  Vec3 expected;
};
class Respond : public testing::TestWithParam<Case> {};
TEST_P(Respond, ChangesTheVelocity) {
  const auto& [name, type, self, other, other_responds, expected] = GetParam();
  KinematicState s = moving({1, 2, 3}, self);
  s.orientation = Quat(0, 1, 0, 0);
  const KinematicState after = answer(type, s, moving({0, 2, 3}, other), other_responds, Vec3::UnitX());
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
  const KinematicState inverse = answer(kInverse, s, {}, false, Vec3::UnitX());
  EXPECT_EQ(inverse.acceleration, s.acceleration);
  EXPECT_EQ(inverse.angular_velocity_body, s.angular_velocity_body);
  const KinematicState zero = answer(kZero, s, {}, false, Vec3::UnitX());
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
    const KinematicState after = answer(kInverse, self, other, false, n);
    const Vec3 was = self.velocity - other.velocity, is = after.velocity - other.velocity;
    EXPECT_NEAR(is.dot(n), std::abs(was.dot(n)), 1e-12);
    EXPECT_LT(((is - is.dot(n) * n) - (was - was.dot(n) * n)).norm(), 1e-12);
  }
}

// Two objects that both answer part, and neither is faster than before. Otherwise a few that bounce off each other
// would explode.
TEST(Respond, TwoThatBothInvertPartAndGainNothing) {
  std::mt19937_64 rng(2);
  int approaching = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 n = random_vector(rng).normalized();
    const KinematicState a = moving({0, 0, 0}, random_vector(rng)), b = moving({0, 0, 0}, random_vector(rng));
    if (n.dot(a.velocity - b.velocity) >= 0.0) continue;
    ++approaching;
    const KinematicState after_a = answer(kInverse, a, b, true, n), after_b = answer(kInverse, b, a, true, -n);
    EXPECT_GT(n.dot(after_a.velocity - after_b.velocity), 0.0);
    EXPECT_NEAR(after_a.velocity.norm(), a.velocity.norm(), 1e-12);
    EXPECT_NEAR(after_b.velocity.norm(), b.velocity.norm(), 1e-12);
  }
  EXPECT_GT(approaching, 300);
}

TEST(RestAgainst, TakesOutWhatApproachesOnly) {
  const KinematicState floor = moving({0, 0, 0}, {0, 1, 0}, {0, 2, 0});
  const KinematicState falling = moving({0, 1, 0}, {3, -4, 5}, {1, -9.81, 0});
  const KinematicState rest = rested({}, falling, floor);
  EXPECT_EQ(rest.velocity, Vec3(3, 1, 5));
  EXPECT_EQ(rest.acceleration, Vec3(1, 2, 0));
  const KinematicState rising = moving({0, 1, 0}, {3, 4, 5}, {1, 9, 0});
  EXPECT_TRUE(same_bits(rested({}, rising, floor), rising));
}

// ---- impulse ----

struct Struck {
  const char* name;
  CollisionResponse self, other;
  double v_self, v_other;  // along the normal, which faces self [m/s]
  bool other_responds;
  double expected;
};
class Impulse : public testing::TestWithParam<Struck> {};
TEST_P(Impulse, ChangesTheVelocityAlongTheNormal) {
  const Struck& c = GetParam();
  const KinematicState self = moving({0, 0, 0}, {c.v_self, 3, -5}, {0, -9.81, 0}),
                       other = moving({-1, 0, 0}, {c.v_other, 7, 0});
  const KinematicState after = respond({c.self, &c.other, c.other_responds, self, other, Vec3::UnitX()});
  EXPECT_DOUBLE_EQ(after.velocity.x(), c.expected);
  EXPECT_EQ(after.velocity.tail<2>(), self.velocity.tail<2>());
  EXPECT_EQ(after.acceleration, self.acceleration);
}
INSTANTIATE_TEST_SUITE_P(
    Table, Impulse,
    testing::Values(Struck{"EqualMassesExchange", impulse(1), impulse(1), -2, 0, true, 0},
                    Struck{"TheOneThatIsHitTakesIt", impulse(1), impulse(1), 0, 2, true, 2},
                    Struck{"HeavyOneGoesOn", impulse(3), impulse(1), -2, 0, true, -1},
                    Struck{"LightOneIsThrownBack", impulse(1), impulse(3), -2, 0, true, 1},
                    Struck{"PlasticGoTogether", impulse(1, 0), impulse(1, 0), -2, 0, true, -1},
                    Struck{"TheSmallerRestitutionCounts", impulse(1, 0.9), impulse(1, 0.5), -2, 0, true, -0.5},
                    Struck{"AWallIsOfInfiniteMass", impulse(1, 0.75), impulse(1), -4, 0, false, 3},
                    Struck{"AWallsRestitutionCounts", impulse(1, 0.9), impulse(1, 0.5), -4, 0, false, 2},
                    Struck{"AnotherResponsesDoesNot", impulse(1, 0.75), CollisionResponse{}, -4, 0, true, 3},
                    Struck{"ARacketThatComesAddsSpeed", impulse(1, 0.5), impulse(1), -10, 4, false, 11},
                    Struck{"WhatPartsKeepsItsSpeed", impulse(1, 0.5), impulse(1), 3, 1, true, 3}),
    [](const auto& c) { return std::string(c.param.name); });

// Newton's law of restitution and the conservation laws hold for any two bodies.
TEST(Respond, ImpulseKeepsMomentumAndPartsByRestitution) {
  std::mt19937_64 rng(3);
  for (int i = 0; i < 1000; ++i) {
    const auto unit = [&] { return static_cast<double>(rng() >> 11) * 0x1p-53; };
    const CollisionResponse of_a = impulse(0.1 + unit(), unit()), of_b = impulse(0.1 + 10.0 * unit(), unit());
    const Vec3 n = random_vector(rng).normalized();
    const KinematicState a = moving({0, 0, 0}, random_vector(rng)), b = moving({0, 0, 0}, random_vector(rng));
    const KinematicState after_a = respond({of_a, &of_b, true, a, b, n}),
                         after_b = respond({of_b, &of_a, true, b, a, -n});
    const auto momentum = [&](const KinematicState& p, const KinematicState& q) {
      return Vec3(of_a.mass_kg * p.velocity + of_b.mass_kg * q.velocity);
    };
    EXPECT_LT((momentum(a, b) - momentum(after_a, after_b)).norm(), 1e-12);
    const double approach = n.dot(b.velocity - a.velocity), part = n.dot(after_a.velocity - after_b.velocity);
    const double e = std::min(of_a.restitution, of_b.restitution);
    EXPECT_NEAR(part, approach > 0.0 ? e * approach : -approach, 1e-12);
  }
}

TEST(RestAgainst, SharesByMassWhatTwoThatAnswerByImpulseLose) {
  const CollisionResponse light = impulse(1, 0.9), heavy = impulse(3, 0.9);
  const KinematicState floor = moving({0, 0, 0}, {0, 1, 0}, {0, 2, 0});
  const KinematicState falling = moving({0, 1, 0}, {3, -3, 5}, {1, -6, 0});
  const KinematicState rest_light = rested(light, falling, floor, &heavy);
  EXPECT_EQ(rest_light.velocity, Vec3(3, 0, 5)) << "the speed of their common centre";
  EXPECT_EQ(rest_light.acceleration, Vec3(1, 0, 0));
  EXPECT_EQ(rested(light, falling, floor).velocity, Vec3(3, 1, 5));
}

TEST(RestAgainst, WhatIsPressedLosesWhatItPartsWith) {
  const CollisionResponse ball = impulse(1, 0.9), other = impulse(3, 0.9);
  const KinematicState floor = moving({0, 0, 0}, {0, 1, 0});
  const KinematicState lifting = moving({0, 1, 0}, {3, 1.5, 5}, {0, -10, 0});
  const auto pressed = [&](const KinematicState& self, const CollisionResponse* other_response, bool answers) {
    return come_to_rest_against({ball, other_response, answers, self, floor, Vec3::UnitY()}, true);
  };
  EXPECT_EQ(pressed(lifting, nullptr, false).velocity, Vec3(3, 1, 5));
  EXPECT_EQ(pressed(lifting, nullptr, false).acceleration, Vec3::Zero());
  EXPECT_EQ(pressed(lifting, &other, true).velocity, Vec3(3, 1.125, 5)) << "its share";
  KinematicState turning = lifting;
  turning.angular_velocity_body = {0, 0, 1};
  EXPECT_EQ(pressed(turning, nullptr, false).velocity, lifting.velocity) << "its edge may be what touches";
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
