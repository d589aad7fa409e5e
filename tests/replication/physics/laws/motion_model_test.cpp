#include "replication/physics/laws/motion_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "replication/physics/laws/timeline.hpp"
#include "tests/must.hpp"
#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::motion_model_test {

using namespace test;

constexpr double kPi = std::numbers::pi;

MotionModel third(const KinematicState& s, const Vec3& jerk) {
  MotionModel m = s;
  m.kind = MotionKind::kThird;
  m.jerk = jerk;
  return m;
}
MotionModel turning(const KinematicState& s, const Vec3& rate) {
  MotionModel m = s;
  m.kind = MotionKind::kTurning;
  m.rate_rad_s = rate;
  return m;
}
MotionModel oscillating(const KinematicState& s, const Vec3& jerk, const Vec3& rate) {
  MotionModel m = third(s, jerk);
  m.kind = MotionKind::kOscillating;
  m.rate_rad_s = rate;
  return m;
}
MotionModel sliding(const Vec3& v, const Vec3& a) {
  MotionModel m = moving({1, 2, 3}, v, a);
  m.kind = MotionKind::kSliding;
  return m;
}

// ---- closed forms against the motions that they describe ----

TEST(Evaluate, FirstAndSecondOrderAreTheProjectsOwn) {
  const KinematicState s = moving({1, 2, 3}, {4, 5, 6}, {0, -9.81, 0});
  EXPECT_TRUE(same_bits(evaluate(s, 1.5), advance(s, 1.5)));
}

TEST(Evaluate, ThirdOrderIsTheCubic) {
  const KinematicState s = evaluate(third(moving({1, 0, 0}, {2, 0, 0}, {3, 0, 0}), {6, 0, 0}), 2.0);
  EXPECT_NEAR(s.position.x(), 1 + 4 + 6 + 8, 1e-14);
  EXPECT_NEAR(s.velocity.x(), 2 + 6 + 12, 1e-14);
  EXPECT_NEAR(s.acceleration.x(), 3 + 12, 1e-14);
}

TEST(Evaluate, TurningGoesRoundACircle) {
  for (const double w : {1e-9, 1e-3, 0.1, 1.0, 7.0, 100.0}) {
    const double r = 3.0, t = 1.7, speed = w * r;
    const MotionModel m = turning(moving({r, 0, 0}, {0, speed, 0}, {-speed * w, 0, 0}), {0, 0, w});
    const KinematicState s = evaluate(m, t);
    EXPECT_NEAR((s.position - r * Vec3(std::cos(w * t), std::sin(w * t), 0)).norm(), 0, 1e-12) << w;
    EXPECT_NEAR((s.velocity - speed * Vec3(-std::sin(w * t), std::cos(w * t), 0)).norm(), 0, 1e-11 * (1 + speed)) << w;
  }
}

TEST(Evaluate, OscillatingIsAWaveOnEachAxis) {
  // Along x the motion is a half-period wave with a drift, along y a slower one, and along z a cubic, because its rate
  // is 0.
  const double t = 1.3;
  const auto wave = [](double s, double w, double phase, int derivative) {
    return std::pow(w, derivative) * 5.0 * std::sin(w * s + phase + derivative * kPi / 2);
  };
  const MotionModel m = oscillating(
      moving({wave(0, 1.7, 0.3, 0), wave(0, 0.4, 1, 0), 0}, {wave(0, 1.7, 0.3, 1) + 2, wave(0, 0.4, 1, 1), 1},
             {wave(0, 1.7, 0.3, 2), wave(0, 0.4, 1, 2), 2}),
      {wave(0, 1.7, 0.3, 3), wave(0, 0.4, 1, 3), 3}, {1.7, 0.4, 0});
  const KinematicState s = evaluate(m, t);
  EXPECT_NEAR(s.position.x(), wave(t, 1.7, 0.3, 0) + 2 * t, 1e-12);
  EXPECT_NEAR(s.position.y(), wave(t, 0.4, 1, 0), 1e-12);
  EXPECT_NEAR(s.position.z(), t + t * t + t * t * t / 2, 1e-12);
  EXPECT_NEAR(s.velocity.x(), wave(t, 1.7, 0.3, 1) + 2, 1e-12);
  EXPECT_NEAR(s.acceleration.y(), wave(t, 0.4, 1, 2), 1e-12);
}

TEST(Evaluate, WavesOfAnyRateMeetTheCubicSmoothly) {  // the series and the closed form where one takes over
  for (double rate = 1e-6; rate < 2.0; rate *= 1.1) {
    const KinematicState s = moving({0, 0, 0}, {1, 0, 0}, {2, 0, 0});
    const double t = 0.5, x = rate * t;
    const KinematicState wave = evaluate(oscillating(s, {3, 0, 0}, {rate, 0, 0}), t);
    const KinematicState cubic = evaluate(third(s, {3, 0, 0}), t);
    EXPECT_NEAR(wave.position.x(), cubic.position.x(), 0.1 * x * x + 1e-10) << rate;
  }
}

TEST(Evaluate, SlidingComesToRestWhereFrictionEndsItAndStays) {
  const MotionModel m = sliding({4, 0, 0}, {-2, 0, 0});
  EXPECT_NEAR(evaluate(m, 1.0).position.x(), 1 + 4 - 1, 1e-15);
  for (const double t : {2.0, 2.5, 100.0}) {
    EXPECT_EQ(evaluate(m, t).position, Vec3(5, 2, 3)) << t;
    EXPECT_TRUE(evaluate(m, t).velocity.isZero(0.0) && evaluate(m, t).acceleration.isZero(0.0)) << t;
  }
}

// A stop may round up to a whole number of nanoseconds. The piece behind it must not begin before the stop.
TEST(Pieces, OfWhatHasSlidToRestStand) {
  for (const auto& [v, by] : {std::pair{3.45, 1.25}, {0.47, 0.5}, {0.47, 1.0}, {1.88, 0.5}, {4.0, 2.0}}) {
    const MotionPiece last = piece_at(sliding({v, 0, 0}, {-by, 0, 0}), from_seconds(10.0));
    EXPECT_TRUE(last.state.velocity.isZero(0.0)) << v;
    EXPECT_TRUE(last.state.acceleration.isZero(0.0)) << v;
    EXPECT_NEAR(last.state.position.x(), 1.0 + 0.5 * v * v / by, 1e-9);
    EXPECT_FALSE(last.end);
  }
}

TEST(Evaluate, SpinsSlideToRestToo) {
  MotionModel m = sliding({4, 0, 0}, {-2, 0, 0});
  m.state.angular_velocity_body = {0, 3, 0};
  m.angular_acceleration_body = {0, -1, 0};
  const Quat at_rest_then(Eigen::AngleAxisd(4.5, Vec3::UnitY()));
  EXPECT_NEAR(angle_between(evaluate(m, 3.0).orientation, at_rest_then), 0, 1e-7);
  EXPECT_NEAR(angle_between(evaluate(m, 9.0).orientation, at_rest_then), 0, 1e-7);
  EXPECT_TRUE(evaluate(m, 9.0).angular_velocity_body.isZero(0.0));
}

// ---- orientation ----

// A spinning object at rest stays where it is, and turns as far as its spin says, for any speed of it.
TEST(Spin, OfAnObjectAtRestIsExactFromNoneTo100RadiansASecond) {
  for (int i = 0; i <= 1000; ++i) {
    const double w = i == 0 ? 0.0 : std::pow(10.0, -10.0 + 12.0 * i / 1000.0);  // 1e-10 .. 100
    KinematicState s = moving({1, 2, 3});
    s.angular_velocity_body = w * Vec3(1, 2, 2) / 3.0;
    const KinematicState later = evaluate(s, 0.7);
    EXPECT_EQ(later.position, s.position);
    EXPECT_TRUE(later.velocity.isZero(0.0));
    EXPECT_NEAR(later.orientation.norm(), 1.0, 1e-15);
    const Quat expected(Eigen::AngleAxisd(0.7 * w, Vec3(1, 2, 2) / 3.0));
    const double same = std::abs(later.orientation.coeffs().dot(expected.coeffs()));
    EXPECT_NEAR(same, 1.0, 1e-13) << w;
  }
}

TEST(Spin, AcceleratesAboutAFixedAxis) {
  for (const double w : {0.0, 1e-9, 1.0, 100.0}) {
    MotionModel m = moving({0, 0, 0});
    m.state.angular_velocity_body = {0, 0, w};
    m.angular_acceleration_body = {0, 0, 5};
    const Quat expected(Eigen::AngleAxisd(w * 0.6 + 2.5 * 0.36, Vec3::UnitZ()));
    EXPECT_NEAR(std::abs(evaluate(m, 0.6).orientation.coeffs().dot(expected.coeffs())), 1.0, 1e-13) << w;
    EXPECT_NEAR(evaluate(m, 0.6).angular_velocity_body.z(), w + 3, 1e-13);
  }
}

// ---- pieces ----

struct Cut {
  const char* name;
  MotionModel model;
};
class Pieces : public testing::TestWithParam<Cut> {};
TEST_P(Pieces, FollowEachOtherWithinTheStatedError) {
  const MotionModel& m = GetParam().model;
  Duration t{0};
  for (int n = 0; n < 500; ++n) {
    const MotionPiece piece = piece_at(m, t);
    ASSERT_EQ(piece.begin, t);
    ASSERT_EQ(piece.end, piece_end(m, t));
    if (!piece.end) break;
    ASSERT_GT(*piece.end, t);
    ASSERT_EQ(piece_at(m, *piece.end - 1ns).begin, piece.begin) << "one piece, wherever it is asked for";
    const double h = to_seconds(*piece.end - t);
    for (const double part : {0.0, 0.21, 0.5, 0.79, 1.0}) {
      const KinematicState is = advance(piece.state, part * h), truth = evaluate(m, to_seconds(t) + part * h);
      const bool at_knot = part == 0.0 || part == 0.5 || part == 1.0;
      EXPECT_LT((is.position - truth.position).norm(), at_knot ? 1e-12 : kPieceError_m) << part;
      EXPECT_LT(angle_between(is.orientation, truth.orientation), part == 0.0 || part == 1.0 ? 1e-6 : kPieceError_rad);
    }
    t = *piece.end;
  }
}
MotionModel speeding_up_its_spin() {
  MotionModel m = moving({1, 0, 0}, {1, 0, 0});
  m.state.angular_velocity_body = {0, 2, 1};
  m.angular_acceleration_body = {1, 0, 3};
  return m;
}
INSTANTIATE_TEST_SUITE_P(
    Table, Pieces,
    testing::Values(Cut{"Second", moving({0, 1, 0}, {1, 2, 3}, {0, -9.81, 0})},
                    Cut{"Third", third(moving({0, 1, 0}, {1, 2, 3}, {0, -9.81, 0}), {20, 0, -10})},
                    Cut{"MuchJerk", third(moving({0, 1, 0}), {10'000, 0, 0})},
                    Cut{"Turning", turning(moving({3, 0, 0}, {0, 6, 0}, {-12, 0, 0}), {0, 0, 2})},
                    Cut{"Oscillating", oscillating(moving({0, 0, 0}, {8, 0, -8}), {-23, 0, 0}, {1.7, 0, 0})},
                    Cut{"TurningLittleButFast", turning(moving({3, 0, 0}, {0, 6, 0}, {-1e-3, 0, 1e-3}), {0, 0, 50})},
                    Cut{"OscillatingLittleButFast",
                        oscillating(moving({0, 0, 0}, {8, 0, 0}, {1e-3, 0, 2e-3}), {0, 0.02, 0}, {50, 3.5, 20})},
                    Cut{"Sliding", sliding({4, 0, 0}, {-2, 0, 0})}, Cut{"Spin", speeding_up_its_spin()}),
    [](const auto& c) { return std::string(c.param.name); });

// Work is bounded whatever a record says: a model has at most 10 s of pieces of 4 ms.
TEST(PieceEnd, ComesSeldomAndAtLastNoMore) {
  MotionModel m = third(moving({0, 0, 0}), {1e9, 0, 0});
  m.angular_acceleration_body = {2e3, 0, 0};
  int pieces = 0;
  Duration t{0};
  for (auto end = piece_end(m, t); end; end = piece_end(m, t), ++pieces) {
    EXPECT_TRUE(*end - t >= 4ms || *end == from_seconds(kModelLasts_s));
    t = *end;
  }
  EXPECT_LE(pieces, 2'400);
  EXPECT_EQ(t, from_seconds(kModelLasts_s));
  const KinematicState last = evaluate(m, kModelLasts_s), later = evaluate(m, kModelLasts_s + 1.0);
  EXPECT_NEAR(((later.position - last.position) / last.velocity.norm()).x(), 1.0, 1e-9) << "on with what it had";
}

TEST(PieceEnd, IsTheTimelinesNextChange) {
  Timeline line(sim(1s), moving({0, 0, 0}));
  line.replace_from(sim(2s), third(moving({0, 0, 0}), {1, 0, 0}), std::nullopt);
  EXPECT_EQ(must(line.next_change_after(sim(2s))) - sim(2s), *piece_end(third(moving({0, 0, 0}), {1, 0, 0}), 0ns));
  line.replace_from(sim(2s) + 1ms, moving({0, 0, 0}), std::nullopt);
  EXPECT_EQ(line.next_change_after(sim(2s)), sim(2s) + 1ms) << "what comes first";
}

// ---- rebasing ----

TEST(Rebased, IsTheSameMotion) {
  std::mt19937_64 rng(7);
  std::uniform_real_distribution<double> u(-5, 5);
  const auto vector = [&] { return Vec3(u(rng), u(rng), u(rng)); };
  for (int i = 0; i < 300; ++i) {
    const KinematicState s = moving(vector(), vector(), vector());
    MotionModel sliding_down = s;
    sliding_down.kind = MotionKind::kSliding;
    sliding_down.state.acceleration = -0.4 * s.velocity;
    for (const MotionModel& m :
         {MotionModel(s), third(s, vector()), turning(s, s.velocity.cross(s.acceleration) / 25.0),
          oscillating(s, vector(), vector().cwiseAbs()), sliding_down}) {
      const KinematicState direct = evaluate(m, 1.9), by_way = evaluate(rebased(m, 0.8), 1.1);
      EXPECT_LT((direct.position - by_way.position).norm(), 1e-10) << to_string(m.kind);
      EXPECT_LT((direct.velocity - by_way.velocity).norm(), 1e-10) << to_string(m.kind);
    }
  }
}

// ---- contacts ----

// A spring whose motion is 5 sin and which is mirrored at x = 0 moves along |5 sin|: one law, for ever.
TEST(AfterContact, AnArcGoesOnAsItsMirrorImage) {
  const double w = 1.7;
  const auto arc = [&](double t) { return std::abs(5 * std::sin(w * t)); };
  const MotionModel m =
      oscillating(moving({5 * std::sin(w), 0, 0}, {5 * w * std::cos(w), 0, -8}, {-5 * w * w * std::sin(w), 0, 0}),
                  {-5 * w * w * w * std::cos(w), 0, 0}, {w, 0, 0});
  const double contact = kPi / w;
  MotionModel before = rebased(m, contact - 1.0);
  KinematicState after = before.state;
  after.velocity.x() *= -1;
  const MotionModel on = after_contact(before, after, Vec3::UnitX(), true);
  for (double t = 0; t < kPi / w; t += 0.1) EXPECT_NEAR(evaluate(on, t).position.x(), arc(contact + t), 1e-12) << t;
}

TEST(AfterContact, WhatIsStoppedFollowsNoLaw) {
  const MotionModel m = third(moving({0, 0, 0}, {1, 0, 0}), {5, 0, 0});
  const MotionModel stopped = after_contact(m, moving({1, 0, 0}), Vec3::UnitX(), false);
  EXPECT_EQ(evaluate(stopped, 3.0).position, Vec3(1, 0, 0));
}

TEST(AfterContact, FrictionTurnsWithTheVelocity) {
  const MotionModel m = sliding({4, 0, 4}, {-2, 0, -2});
  KinematicState after = m.state;
  after.velocity.x() = -4;
  const MotionModel on = after_contact(m, after, -Vec3::UnitX(), true);
  EXPECT_EQ(evaluate(on, 10.0).position, Vec3(1 - 4, 2, 3 + 4)) << "2 s from 4 m/s, whatever the way";
}

TEST(MotionKindName, IsDistinctForEach) {
  std::vector<std::string> names;
  for (const MotionKind kind : kMotionKinds) names.emplace_back(to_string(kind));
  std::ranges::sort(names);
  EXPECT_EQ(std::ranges::unique(names).begin(), names.end());
  EXPECT_EQ(std::ranges::count(names, "?"), 0);
}

// ---- parts of the closed form ----

TEST(Evaluate, ItsPartsAreTheSameToTheLastBit) {
  std::mt19937_64 rng(11);
  const auto draw = [&] { return 4.0 * std::ldexp(static_cast<double>(rng() >> 11), -53) - 2.0; };
  const auto vec = [&] { return Vec3(draw(), draw(), draw()); };
  for (int round = 0; round < 2000; ++round) {
    MotionModel m = moving(vec(), vec(), vec());
    m.kind = kMotionKinds[rng() % std::size(kMotionKinds)];
    m.jerk = m.kind == MotionKind::kThird || m.kind == MotionKind::kOscillating ? vec() : Vec3(Vec3::Zero());
    if (m.kind == MotionKind::kTurning) m.rate_rad_s = vec();
    if (m.kind == MotionKind::kOscillating) m.rate_rad_s = Vec3(std::abs(draw()), 0.0, 3.0 * std::abs(draw()));
    m.state.orientation = quat_exp(vec());
    if (rng() % 4 > 0) m.state.angular_velocity_body = vec();
    if (rng() % 2 > 0) m.angular_acceleration_body = vec();
    const double t = 3.0 * (draw() + 2.0);  // beyond kModelLasts_s, too
    const KinematicState all = evaluate(m, t);
    ASSERT_EQ(position_after(m, t), all.position);
    ASSERT_EQ(orientation_after(m, t).coeffs(), all.orientation.coeffs());
  }
}

// A law in another frame is the same motion.
TEST(InFrame, IsTheSameMotion) {
  const Pose frame{Vec3(1, -2, 3), Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()))};
  for (const MotionKind kind : kMotionKinds) {
    MotionModel law(moving({4, 5, 6}, {1, -2, 0.5}));
    law.kind = kind;
    if (kind != MotionKind::kFirst) law.state.acceleration = {0.3, 0.1, -0.2};
    if (kind == MotionKind::kSliding) law.state.acceleration = -0.1 * law.state.velocity;
    if (kind == MotionKind::kThird || kind == MotionKind::kOscillating) law.jerk = {0.1, 0, -0.3};
    if (kind == MotionKind::kTurning || kind == MotionKind::kOscillating) law.rate_rad_s = {0.5, 1.0, 0.2};
    law.state.angular_velocity_body = {0.1, 0.2, 0.3};
    const MotionModel seen = in_frame(frame, law);
    EXPECT_TRUE(within_limits(seen));
    const double lasts_s =
        kind == MotionKind::kOscillating ? 0.0 : 2.0;  // of which the state counts, in a turned frame
    for (const double t_s : {0.0, lasts_s}) {
      const KinematicState a = evaluate(law, t_s), b = evaluate(seen, t_s);
      EXPECT_LT((frame * b.position - a.position).norm(), 1e-12) << to_string(kind);
      EXPECT_LT((frame.orientation * b.velocity - a.velocity).norm(), 1e-12) << to_string(kind);
      EXPECT_LT((frame.orientation * b.orientation).angularDistance(a.orientation), 1e-7) << to_string(kind);
    }
  }
  MotionModel waves(moving({4, 5, 6}, {1, -2, 0.5}));
  waves.kind = MotionKind::kOscillating;
  waves.rate_rad_s = {1, 2, 3};
  const MotionModel moved = in_frame({Vec3(1, 1, 1), Quat::Identity()}, waves);
  EXPECT_EQ(moved.kind, MotionKind::kOscillating);
  EXPECT_EQ(evaluate(moved, 3.0).velocity, evaluate(waves, 3.0).velocity);
}

}  // namespace peerd::replication::motion_model_test
