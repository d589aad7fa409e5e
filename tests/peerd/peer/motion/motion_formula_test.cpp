#include "peerd/peer/motion/motion_formula.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "peerd/peer/motion/right_derivatives.hpp"
#include "tests/must.hpp"

namespace peerd::motion::motion_formula_test {

using std::numbers::pi;
using testing::HasSubstr;

FormulaMotion motion(const MotionFormula& formula) { return must(FormulaMotion::make(formula, "m", 15.0)); }

// The formulas of a motion along x, y and z.
MotionFormula path(const std::string& x, const std::string& y = "0", const std::string& z = "0") {
  MotionFormula f;
  f.x = x, f.y = y, f.z = z;
  return f;
}
MotionFormula defining(std::vector<std::string> define, MotionFormula f) {
  f.define = std::move(define);
  return f;
}
MotionFormula turning(std::vector<double> axis, const std::string& angle, MotionFormula f = {}) {
  f.axis = std::move(axis);
  f.angle = angle;
  return f;
}
MotionFormula held(MotionFormula f) {
  f.hold_before_start = true;
  return f;
}

// ---- a table of formulas ----

using Derivative = std::function<double(double)>;
struct Formula {
  const char *name, *text;
  Derivative value, first, second;  // from the right
  std::vector<double> times;        // beside the corners and every tick of 15 s
  double first_error = 1e-6, second_error = 1e-2;
};

double sign_right(double x) { return x >= 0.0 ? 1.0 : -1.0; }

const Formula kFormulas[] = {
    {"Rest", "3", [](double) { return 3.0; }, [](double) { return 0.0; }, [](double) { return 0.0; }, {}},
    {"Line",
     "2 - 7*t",
     [](double t) { return 2 - 7 * t; },
     [](double) { return -7.0; },
     [](double) { return 0.0; },
     {}},
    {"Parabola",
     "100 + 3*t - 4.905*t^2",
     [](double t) { return 100 + 3 * t - 4.905 * t * t; },
     [](double t) { return 3 - 9.81 * t; },
     [](double) { return -9.81; },
     {}},
    {"Sine",
     "5*sin(2*t)",
     [](double t) { return 5 * std::sin(2 * t); },
     [](double t) { return 10 * std::cos(2 * t); },
     [](double t) { return -20 * std::sin(2 * t); },
     {}},
    {"FastSine",
     "0.1*sin(20*t)",
     [](double t) { return 0.1 * std::sin(20 * t); },
     [](double t) { return 2 * std::cos(20 * t); },
     [](double t) { return -40 * std::sin(20 * t); },
     {},
     1e-5,
     5e-2},
    {"Exponential",
     "exp(t/5)",
     [](double t) { return std::exp(t / 5); },
     [](double t) { return std::exp(t / 5) / 5; },
     [](double t) { return std::exp(t / 5) / 25; },
     {}},
    // Corners: exactly there, shortly before, shortly after.
    {"Bounce",
     "abs(t - 1)",
     [](double t) { return std::abs(t - 1); },
     [](double t) { return sign_right(t - 1); },
     [](double) { return 0.0; },
     {1.0, 1.0 - 1e-3, 1.0 - 1e-4, 1.0 + 1e-9, 1.0 + 1e-4}},
    {"Jerk",
     "t < 2 ? 0 : 3*(t - 2)^2",
     [](double t) { return t < 2 ? 0.0 : 3 * (t - 2) * (t - 2); },
     [](double t) { return t < 2 ? 0.0 : 6 * (t - 2); },
     [](double t) { return t < 2 ? 0.0 : 6.0; },
     {2.0, 2.0 - 1e-3, 2.0 + 1e-3}},
    {"BouncedSine",
     "abs(5*sin(t))",
     [](double t) { return std::abs(5 * std::sin(t)); },
     [](double t) { return sign_right(std::sin(t)) * 5 * std::cos(t); },
     [](double t) { return -sign_right(std::sin(t)) * 5 * std::sin(t); },
     {3.1415926536, pi - 1e-3, pi - 1e-4, 2 * pi - 1e-3}},
};

class FormulaTest : public testing::TestWithParam<Formula> {
 protected:
  static void check_at(const FormulaMotion& source, double t) {
    const Formula& f = GetParam();
    const KinematicState s = source.sample(t);
    EXPECT_NEAR(s.position.y(), f.value(t), 1e-12 * std::max(1.0, std::abs(f.value(t)))) << "t = " << t;
    EXPECT_NEAR(s.velocity.y(), f.first(t), f.first_error * std::max(1.0, std::abs(f.first(t)))) << "t = " << t;
    EXPECT_NEAR(s.acceleration.y(), f.second(t), f.second_error * std::max(1.0, std::abs(f.second(t)))) << "t = " << t;
    EXPECT_EQ(s.position.x(), 0.0);
    EXPECT_EQ(s.velocity.z(), 0.0);
  }
};
TEST_P(FormulaTest, HasItsRightDerivatives) {
  const FormulaMotion source = motion(path("0", GetParam().text));
  for (const double t : GetParam().times) check_at(source, t);
  for (int tick = -60; tick <= 900; ++tick) check_at(source, tick / 60.0);
}
INSTANTIATE_TEST_SUITE_P(Table, FormulaTest, testing::ValuesIn(kFormulas),
                         [](const auto& c) { return std::string(c.param.name); });

// ---- equation 4.7 ----

constexpr double kSpeed = 40 * pi / 15;

double eq47_x(double s) {
  return s < 10 * pi ? s / 6 : s <= 20 * pi ? (20 * pi - s) / 6 : std::abs(5 * std::sin(s / 5));
}
// `at_corner` after 20 pi: the arc that follows is chosen by s + a nanometre, so that a rounding of 1e-15 m decides
// nothing.
double eq47_dx(double s) {
  const double after = s + 1e-9;
  const double slope = after < 10 * pi   ? 1.0 / 6
                       : after < 20 * pi ? -1.0 / 6
                                         : sign_right(std::sin(after / 5)) * std::cos(s / 5);
  return slope * kSpeed;
}
double eq47_ddx(double s) {
  const double after = s + 1e-9;
  return after < 20 * pi ? 0.0 : -sign_right(std::sin(after / 5)) * std::sin(s / 5) / 5 * kSpeed * kSpeed;
}

// The table above has one corner at a time; here all the corners lie on ticks or shortly after one: |z| = 10 pi at
// 3.75 s, 20 pi at 7.5 s, 25, 30 and 35 pi at 9.375, 11.25 and 13.125 s.
TEST(Eq47, HasItsRightDerivativesAtEveryTickOfEveryRate) {
  const FormulaMotion car = motion(
      defining({"s = 40*pi*t/15"}, path("s < 10*pi ? s/6 : s <= 20*pi ? (20*pi - s)/6 : abs(5*sin(s/5))", "0", "-s")));
  for (const int tick_hz : {30, 60, 64, 144, 1000}) {
    for (int tick = -tick_hz; tick < 15 * tick_hz; ++tick) {
      const double t = static_cast<double>(tick) / tick_hz, s = kSpeed * t;
      SCOPED_TRACE(testing::Message() << "t = " << t << " at " << tick_hz << " Hz");
      const KinematicState state = car.sample(t);
      ASSERT_NEAR(state.position.x(), eq47_x(s), 1e-9);
      ASSERT_NEAR(state.position.z(), -s, 1e-9);
      ASSERT_NEAR(state.velocity.x(), eq47_dx(s), 1e-5);
      ASSERT_NEAR(state.velocity.z(), -kSpeed, 1e-5);
      ASSERT_NEAR(state.acceleration.x(), eq47_ddx(s), 0.05);
      ASSERT_NEAR(state.acceleration.z(), 0.0, 0.05);
    }
  }
}

// ---- the language ----

TEST(Motion, LaterDefinitionsUseEarlierOnes) {
  const FormulaMotion m =
      motion(defining({"a = 2*t", "b=a + 1", "long_name2   =   b*b"}, path("long_name2", "a", "b")));
  EXPECT_EQ(m.pose(3.0).position, Vec3(49, 6, 7));
  EXPECT_EQ(m.pose(1.0).position, Vec3(9, 2, 3)) << "again, at another time";
  EXPECT_NEAR(m.sample(3.0).velocity.x(), 28.0, 1e-5);
}

TEST(Motion, SamplesAndPosesAreOne) {
  const FormulaMotion m = motion(turning({1, 2, 2}, "t^2", path("sin(t)")));
  for (const double t : {-1.0, 0.0, 0.3, 7.7}) {
    const KinematicState s = m.sample(t);
    EXPECT_EQ(s.position, m.pose(t).position);
    EXPECT_EQ(s.orientation.coeffs(), m.pose(t).orientation.coeffs());
  }
}

TEST(Motion, TurnsAboutItsAxis) {
  const FormulaMotion m = motion(turning({0, 0, 5}, "pi/2*t"));
  const KinematicState s = m.sample(1.0);
  EXPECT_LT((s.orientation * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-12) << "right-handed, the axis normalised";
  EXPECT_LT((s.angular_velocity_body - Vec3(0, 0, pi / 2)).norm(), 1e-5);
  const FormulaMotion tilted = motion(turning({1, 1, 1}, "abs(t - 2)"));
  EXPECT_NEAR(tilted.sample(2.0).angular_velocity_body.norm(), 1.0, 1e-5) << "a right derivative too";
  EXPECT_GT(tilted.sample(2.0).angular_velocity_body.x(), 0.0);
  EXPECT_LT(tilted.sample(1.9).angular_velocity_body.x(), 0.0);
}

TEST(Motion, FormulasKnowTheObjectsNumber) {
  const auto made = must(FormulaMotion::make(defining({"twice = 2*n"}, path("twice + t", "n")), "m", 15.0, 3));
  EXPECT_EQ(made.pose(1.0).position, Vec3(7, 3, 0));
  EXPECT_EQ(motion(path("n")).pose(1.0).position.x(), 0.0) << "alone";
}

MotionFormula orbiting() {
  MotionFormula f = turning({1, 2, -1}, "0.4*t^2 + t", path("sin(t)", "2", "-t"));
  f.offset = {3, -1, 2};
  f.spin_axis = {0, 1, 1};
  f.spin_angle = "2*sin(t)";
  return f;
}

// Every part of a sample against differences of poses; they are right to about h^2.
TEST(Motion, AnOffsetTurnsAndASpinIsInTheBody) {
  const FormulaMotion m = motion(orbiting());
  constexpr double h = 1e-4;
  for (const double t : {-1.0, 0.0, 0.7, 3.0}) {
    SCOPED_TRACE(t);
    const KinematicState s = m.sample(t);
    const Pose before = m.pose(t - h), now = m.pose(t), after = m.pose(t + h);
    EXPECT_LT((s.position - now.position).norm(), 1e-12);
    EXPECT_LT(angle_between(s.orientation, now.orientation), 1e-7);
    EXPECT_LT((s.velocity - (after.position - before.position) / (2 * h)).norm(), 1e-5);
    EXPECT_LT((s.acceleration - (after.position - 2.0 * now.position + before.position) / (h * h)).norm(), 1e-3);
    const Vec3 spin = 2.0 * (before.orientation.conjugate() * after.orientation).vec() / (2 * h);
    EXPECT_LT((s.angular_velocity_body - spin).norm(), 1e-5);
  }
  const Quat turn(Eigen::AngleAxisd(1.4, Vec3(1, 2, -1).normalized()));
  EXPECT_LT((m.pose(1.0).position - (Vec3(std::sin(1.0), 2, -1) + turn * Vec3(3, -1, 2))).norm(), 1e-12);
  EXPECT_LT(angle_between(m.pose(0.0).orientation, Quat::Identity()), 1e-12);
}

TEST(Motion, AnOffsetCountsWhereNothingTurns) {
  MotionFormula f = path("t");
  f.offset = {0, 5, 0};
  EXPECT_EQ(motion(f).pose(2.0).position, Vec3(2, 5, 0));
  EXPECT_EQ(motion(f).sample(2.0).position, Vec3(2, 5, 0));
}

// The sample says where a body is a moment later: turning for dt with that spin gives the next sample.
TEST(Motion, SpinPredictsTheOrientation) {
  const FormulaMotion m = motion(turning({3, -1, 2}, "0.7*t"));
  const KinematicState later = advance(m.sample(1.0), 0.25);
  EXPECT_LT(angle_between(later.orientation, m.pose(1.25).orientation), 1e-6);
}

TEST(Motion, HoldsStillBeforeTheStartOrRuns) {
  const FormulaMotion runs = motion(path("t"));
  EXPECT_EQ(runs.pose(-2.0).position.x(), -2.0);
  EXPECT_NEAR(runs.sample(-2.0).velocity.x(), 1.0, 1e-6);
  const FormulaMotion holds = motion(held(turning({0, 1, 0}, "t", path("1 + t"))));
  const KinematicState before = holds.sample(-0.001);
  EXPECT_EQ(before.position.x(), 1.0);
  EXPECT_EQ(before.velocity.x(), 0.0);
  EXPECT_TRUE(before.angular_velocity_body.isZero(0.0));
  EXPECT_EQ(holds.pose(-5.0).position.x(), 1.0);
  EXPECT_NEAR(holds.sample(0.0).velocity.x(), 1.0, 1e-6) << "what follows";
}

TEST(Motion, IsMovedWithItsFormulas) {
  FormulaMotion first = motion(defining({"a = t"}, path("a")));
  const FormulaMotion second = std::move(first);
  EXPECT_EQ(second.pose(4.0).position.x(), 4.0);
}

TEST(Motion, WrongFormulasAreNamed) {
  const auto error = [](const MotionFormula& formula) {
    const auto made = FormulaMotion::make(formula, "peer.a.motion.CAR", 15.0);
    if (made) return std::string("accepted");
    EXPECT_EQ(made.error().exit_code, 2);
    return made.error().text;
  };
  EXPECT_THAT(error(path("sin(")), HasSubstr("peer.a.motion.CAR: formula \"sin(\": "));
  EXPECT_THAT(error(path("0", "speed*t")), HasSubstr("speed"));
  EXPECT_THAT(error(defining({"b = a", "a = 1"}, {})), HasSubstr("formula \" a\"")) << "not defined yet";
  EXPECT_THAT(error(defining({"just words"}, {})), HasSubstr("write \"just words\" as \"name = expression\""));
  EXPECT_THAT(error(defining({"= 3"}, {})), HasSubstr("name = expression"));
  EXPECT_THAT(error(defining({"2x = 3"}, {})), HasSubstr("peer.a.motion.CAR"));
  EXPECT_THAT(error(path("")), HasSubstr("formula \"\""));
  EXPECT_THAT(error(path("sqrt(t)")), HasSubstr("not finite at t = -2")) << "and says what helps";
  EXPECT_THAT(error(path("sqrt(t)")), HasSubstr("before_start = \"hold\""));
  EXPECT_EQ(error(held(path("sqrt(t)"))), "accepted");
  EXPECT_THAT(error(path("1/(t - 15)")), HasSubstr("not finite at t = 15"));
}

// ---- the differences themselves ----

TEST(RightDerivatives, StepShortOfACornerThatFollows) {
  for (const double gap : {0.02, 1e-2, 1e-3, 1e-4}) {
    const auto corner = [&](double t) { return t < gap ? 2.0 * t : 2.0 * gap - 5.0 * (t - gap); };
    const RightDerivatives d = right_derivatives(corner, 0.0);
    EXPECT_NEAR(d.first, 2.0, 1e-6) << gap;
    EXPECT_NEAR(d.second, 0.0, 1e-2) << gap;
  }
}

TEST(RightDerivatives, OfWhatDoesNotChangeAreZero) {
  for (const double value : {0.1, -1.8363384198991106, 1e6 / 3.0}) {
    const RightDerivatives d = right_derivatives([&](double) { return value; }, 7.0);
    EXPECT_EQ(d.value, value);
    EXPECT_EQ(d.first, 0.0);
    EXPECT_EQ(d.second, 0.0);
  }
}

TEST(RightDerivatives, NeverLookLeft) {
  const auto right_only = [](double t) {
    EXPECT_GE(t, 3.0);
    return t * t;
  };
  EXPECT_NEAR(right_derivatives(right_only, 3.0).first, 6.0, 1e-9);
}

}  // namespace peerd::motion::motion_formula_test
