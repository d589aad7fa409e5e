#include "replication/physics/laws/model_choice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::model_choice_test {

using namespace test;

using Motion = std::function<KinematicState(double)>;
constexpr Horizon kFar{0.3, 0.4};

SimTime tick(int i) { return sim(10s) + Duration{i * 1'000'000'000LL / 60}; }

ModelChooser after(const Motion& motion, int ticks, const ModelPolicy& policy = {}, const Horizon& horizon = kFar) {
  ModelChooser chooser(policy);
  for (int i = 0; i <= ticks; ++i) chooser.push(tick(i), motion(to_seconds(tick(i) - tick(0))), horizon);
  return chooser;
}

KinematicState circle(double t) {
  return moving({3 * std::cos(2 * t), 1, 3 * std::sin(2 * t)}, {-6 * std::sin(2 * t), 0, 6 * std::cos(2 * t)},
                {-12 * std::cos(2 * t), 0, -12 * std::sin(2 * t)});
}
KinematicState wave(double t) {
  return moving({5 * std::sin(1.7 * t), 0, -8 * t}, {8.5 * std::cos(1.7 * t), 0, -8},
                {-14.45 * std::sin(1.7 * t), 0, 0});
}
KinematicState fall(double t) { return advance(moving({0, 100, 0}, {3, 0, 0}, {0, -9.81, 0}), t); }
KinematicState straight(double t) { return advance(moving({0, 0, 0}, {3, 4, 5}), t); }
KinematicState cubic(double t) { return moving({t * t * t, 0, 2 * t}, {3 * t * t, 0, 2}, {6 * t, 0, 0}); }
KinematicState brake(double t) {
  return t < 2 ? advance(moving({0, 0, 0}, {8, 0, 6}, {-4, 0, -3}), t) : moving({8, 0, 6});
}

struct Case {
  const char* name;
  KinematicState (*motion)(double);
  MotionKind expected;
};
class Chosen : public testing::TestWithParam<Case> {};
// The chosen kind is the law of the motion, so its prediction stays right for long after one update.
TEST_P(Chosen, IsTheLawThatMovesIt) {
  ModelChooser chooser = after(GetParam().motion, 60);
  const MotionModel model = chooser.choose();
  EXPECT_STREQ(to_string(model.kind), to_string(GetParam().expected));
  const double now = to_seconds(tick(60) - tick(0));
  for (const double ahead : {0.1, 0.5, 0.9}) {
    EXPECT_LT((evaluate(model, ahead).position - GetParam().motion(now + ahead).position).norm(), 1e-5) << ahead;
  }
}
INSTANTIATE_TEST_SUITE_P(Table, Chosen,
                         testing::Values(Case{"Straight", straight, MotionKind::kFirst},
                                         Case{"Ballistic", fall, MotionKind::kSecond},
                                         Case{"Circle", circle, MotionKind::kTurning},
                                         Case{"Cubic", cubic, MotionKind::kThird},
                                         Case{"Wave", wave, MotionKind::kOscillating}),
                         [](const auto& c) { return std::string(c.param.name); });

// An object that brakes could go backwards afterwards, or stop. Until it has stopped once nothing distinguishes the
// two, so the chooser treats them as one.
TEST(Choice, OfWhatBrakesEndsAtRestWhereThatIsAllowed) {
  ModelPolicy policy;
  policy.allowed.fill(false);
  policy.allowed[6] = true;  // kSliding
  policy.first = MotionKind::kSliding;
  ModelChooser chooser = after(brake, 60, policy);
  const MotionModel model = chooser.choose();
  EXPECT_EQ(model.kind, MotionKind::kSliding);
  EXPECT_LT((evaluate(model, 30.0).position - Vec3(8, 0, 6)).norm(), 1e-9) << "exact after one update";
}

TEST(Choice, KeepsToWhatIsAllowed) {
  for (std::size_t i = 0; i < std::size(kMotionKinds); ++i) {
    ModelPolicy policy;
    policy.allowed.fill(false);
    policy.allowed[i] = true;
    policy.first = kMotionKinds[i];
    ModelChooser chooser = after(circle, 60, policy);
    const MotionKind chosen = chooser.choose().kind;
    const bool none = kMotionKinds[i] == MotionKind::kSliding;  // nothing brakes on a circle
    EXPECT_EQ(chosen, none ? MotionKind::kSecond : kMotionKinds[i]);
  }
}

// A bounce says nothing about predictions from before it, and no derivative is taken across it.
TEST(Choice, ForgetsAtACorner) {
  const double corner = to_seconds(tick(60) - tick(0)) - 1e-6;
  const Motion bounces = [&](double t) {
    KinematicState s = wave(t < corner ? t : 2 * corner - t);
    if (t >= corner) s.velocity *= -1;
    return s;
  };
  ModelChooser at = after(bounces, 60), later = after(bounces, 63), before_that = after(bounces, 61);
  EXPECT_EQ(at.choose().kind, MotionKind::kSecond) << "what needs no past";
  const MotionModel model = later.choose();
  EXPECT_EQ(model.kind, MotionKind::kOscillating) << "three samples later it is known again";
  EXPECT_NE(before_that.choose().kind, MotionKind::kOscillating) << "not by what was before";
  const double now = to_seconds(tick(63) - tick(0));
  EXPECT_LT((evaluate(model, 0.5).position - bounces(now + 0.5).position).norm(), 1e-3);
}

// The samples shake: a model that extrapolates their second derivative would be off by metres.
TEST(Choice, OfNoiseIsWhatNoiseMovesLeast) {
  std::mt19937_64 rng(5);
  std::normal_distribution<double> noise;
  const Motion shakes = [&](double t) {
    KinematicState s = straight(t);
    for (int i = 0; i < 3; ++i) {
      s.position[i] += 1e-3 * noise(rng);
      s.velocity[i] += 0.05 * noise(rng);
      s.acceleration[i] += 5.0 * noise(rng);
    }
    return s;
  };
  ModelChooser chooser(ModelPolicy{});
  int changes = 0;
  std::optional<MotionKind> last;
  double worst = 0;
  for (int i = 0; i <= 600; ++i) {
    const double t = to_seconds(tick(i) - tick(0));
    chooser.push(tick(i), shakes(t), kFar);
    const MotionModel model = chooser.choose();
    if (i > 120) worst = std::max(worst, (evaluate(model, 0.7).position - straight(t + 0.7).position).norm());
    changes += last && *last != model.kind;
    last = model.kind;
  }
  EXPECT_LT(worst, 0.5) << "acceleration's 5 m/s^2 alone would be 1.2 m, and three times that at times";
  EXPECT_LT(changes, 20) << "it does not flap";
}

TEST(Choice, DependsOnTheSamplesAlone) {
  ModelChooser a = after(wave, 200), b = after(wave, 200);
  EXPECT_TRUE(same_bits(a.choose().state, b.choose().state));
  EXPECT_EQ(a.choose().jerk, b.choose().jerk);
}

TEST(Choice, OfASpinThatChangesNamesItsAcceleration) {
  const Motion spins_up = [](double t) {
    KinematicState s = moving({1, 2, 3});
    s.angular_velocity_body = {0, 1 + 4 * t, 0};
    s.orientation = Quat(Eigen::AngleAxisd(t + 2 * t * t, Vec3::UnitY()));
    return s;
  };
  ModelChooser chooser = after(spins_up, 60);
  EXPECT_NEAR(chooser.choose().angular_acceleration_body.y(), 4.0, 1e-6);
  const Motion spins = [](double t) {
    KinematicState s = moving({1, 2, 3});
    s.angular_velocity_body = {0, 9, 0};
    s.orientation = Quat(Eigen::AngleAxisd(9 * t, Vec3::UnitY()));
    return s;
  };
  EXPECT_TRUE(after(spins, 60).choose().angular_acceleration_body.isZero(0.0));
}

// Whatever samples come in, receivers accept the chosen model.
TEST(Choice, OfNonsenseIsWithinLimits) {
  std::mt19937_64 rng(9);
  ModelChooser chooser(ModelPolicy{});
  for (int i = 0; i < 2000; ++i) {
    const auto wild = [&] { return std::pow(10.0, static_cast<double>(rng() % 24) - 12) * (rng() % 2 ? 1 : -1); };
    KinematicState s = moving({wild(), wild(), wild()}, {wild(), 0, wild()}, {wild(), wild(), 0});
    s.angular_velocity_body = Vec3(wild(), wild(), wild()).normalized() * 1e4;
    if (rng() % 4 == 0) s = moving({wild(), 0, 0});
    chooser.push(tick(i), s, kFar);
    EXPECT_TRUE(within_limits(chooser.choose()));
  }
}

}  // namespace peerd::replication::model_choice_test
