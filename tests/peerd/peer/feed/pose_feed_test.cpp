#include "peerd/peer/feed/pose_feed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace peerd::feed::pose_feed_test {

using namespace std::chrono_literals;

constexpr HostTime kBegin{1000s};
constexpr Duration kStale = 500ms;

HostTime after(double s) { return kBegin + from_seconds(s); }

// The state on a circle of 2 m about +y at 3 m/s, oriented along the motion.
constexpr double kRadius = 2.0, kOmega = 1.5, kSpeed = kRadius * kOmega, kThird = kSpeed * kOmega * kOmega;
KinematicState circle(double t) {
  const double a = kOmega * t, s = std::sin(a), c = std::cos(a);
  KinematicState k{.position = kRadius * Vec3(c, 0.0, -s), .velocity = kRadius * kOmega * Vec3(-s, 0.0, -c)};
  k.acceleration = -kOmega * kOmega * k.position;
  k.orientation = Quat(Eigen::AngleAxisd(a, Vec3::UnitY()));
  k.angular_velocity_body = kOmega * Vec3::UnitY();
  return k;
}

struct Sent {
  double sampled_s, heard_s;
};

// Samples of the circle at uneven intervals, d or up to a fifth less; each arrives at most j later, in order.
std::vector<Sent> jittered(double d_s, double j_s, double until_s, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto fraction = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<Sent> sent;
  for (double t = 0.0; t < until_s; t += d_s * (1.0 - 0.2 * fraction())) {
    const double heard = t + j_s * fraction();
    sent.push_back({t, sent.empty() ? heard : std::max(heard, sent.back().heard_s + 1e-6)});
  }
  return sent;
}

enum class Says { kPose, kVelocity, kAll };
PoseSample sample_of(const KinematicState& k, Says says) {
  PoseSample p{.position = k.position, .orientation = k.orientation};
  if (says != Says::kPose) p.velocity = k.velocity;
  if (says == Says::kAll) {
    p.acceleration = k.acceleration;
    p.angular_velocity_body = k.angular_velocity_body;
  }
  return p;
}

// Newton's remainder: the parabola reaches e ahead of three points that are g apart.
double remainder_m(double e, double g) { return kThird / 6.0 * e * (e + g) * (e + 2.0 * g); }

struct Rate {
  const char* name;
  double hz, jitter_s;
  Says says;
};
class OnACircle : public testing::TestWithParam<Rate> {
 protected:
  // The largest error at ticks of that rate, once three poses are known.
  static double worst_m(const std::vector<Sent>& sent, bool stamped, Says says, double tick_hz) {
    PoseFeed feed({}, kStale);
    double worst = 0.0;
    std::size_t next = 0;
    for (int tick = 0; tick / tick_hz < sent.back().heard_s; ++tick) {
      const double t = tick / tick_hz;
      for (; next < sent.size() && sent[next].heard_s <= t; ++next) {
        const auto stamp = stamped ? std::optional(after(sent[next].sampled_s)) : std::nullopt;
        EXPECT_TRUE(feed.push(after(sent[next].heard_s), stamp, sample_of(circle(sent[next].sampled_s), says)));
      }
      if (t < 0.5) continue;
      const KinematicState s = feed.at(after(t));
      worst = std::max(worst, (s.position - circle(t).position).norm());
      if (!stamped) continue;
      EXPECT_LT(s.orientation.angularDistance(circle(t).orientation), 1e-6) << "at " << t;
      // The velocity is the parabola's, so it belongs to the position.
      EXPECT_NEAR((s.velocity - circle(t).velocity).norm(), 0.0, 0.15 * kSpeed) << "at " << t;
    }
    return worst;
  }
};
TEST_P(OnACircle, TheStateAtATickIsOffByNewtonsRemainderAtMost) {
  const double d = 1.0 / GetParam().hz, j = GetParam().jitter_s, e = d + j;
  const double spacing = to_seconds(PoseFeed::kSpacing);
  const double bound = remainder_m(e, 0.8 * d >= spacing ? d : d + spacing);
  for (const double tick_hz : {30.0, 60.0, 144.0}) {
    const double worst = worst_m(jittered(d, j, 20.0, 1), true, GetParam().says, tick_hz);
    EXPECT_LT(worst, bound) << tick_hz << " Hz";
    if (GetParam().says == Says::kPose) {
      EXPECT_GT(worst, bound / 20.0) << "or the bound says nothing; " << tick_hz << " Hz";
    }
    RecordProperty("worst_mm_at_" + std::to_string(static_cast<int>(tick_hz)), std::to_string(1e3 * worst));
  }
  RecordProperty("bound_mm", std::to_string(1e3 * bound));
}
// Poses without a time are off by up to the motion within the jitter, which the parabola magnifies by up to Lebesgue's
// constant.
TEST_P(OnACircle, WithoutTimesTheJitterCountsToo) {
  const double d = 1.0 / GetParam().hz, j = GetParam().jitter_s, e = d + j;
  const double s = to_seconds(PoseFeed::kSpacingUnstamped);
  const double lebesgue = (e + s) * (e + 2 * s) / (2 * s * s) + e * (e + 2 * s) / (s * s) + e * (e + s) / (2 * s * s);
  // A velocity belongs to the time of its pose, not to that of its arrival.
  const double velocity_off = GetParam().says == Says::kPose ? 0.0 : kSpeed * kOmega * j * e * (1.0 + e / s);
  const double bound = remainder_m(e, s + e) + lebesgue * kSpeed * j + velocity_off;
  const double worst = worst_m(jittered(d, j, 20.0, 2), false, GetParam().says, 60.0);
  EXPECT_LT(worst, bound);
  RecordProperty("worst_mm", std::to_string(1e3 * worst));
  RecordProperty("bound_mm", std::to_string(1e3 * bound));
}
INSTANTIATE_TEST_SUITE_P(Table, OnACircle,
                         testing::Values(Rate{"At30Hz", 30, 0.010, Says::kPose}, Rate{"At60Hz", 60, 0.008, Says::kPose},
                                         Rate{"At100Hz", 100, 0.008, Says::kPose},
                                         Rate{"At1000Hz", 1000, 0.001, Says::kPose},
                                         Rate{"At30HzWithVelocity", 30, 0.010, Says::kVelocity},
                                         Rate{"At100HzWithVelocity", 100, 0.008, Says::kVelocity},
                                         Rate{"At30HzWithAll", 30, 0.010, Says::kAll}),
                         [](const auto& c) { return std::string(c.param.name); });

// Poses come a tenth of a second ahead of time, so the state is interpolated between them.
TEST(PoseFeed, PosesOfTheFutureAreInterpolated) {
  PoseFeed feed({}, kStale);
  const double d = 1.0 / 60.0, ahead = 0.1;
  double worst = 0.0;
  for (int i = 0; i < 600; ++i) {
    const double t = i * d;
    ASSERT_TRUE(feed.push(after(t), after(t + ahead), sample_of(circle(t + ahead), Says::kPose)));
    if (t < 0.5) continue;
    worst = std::max(worst, (feed.at(after(t + 0.4 * d)).position - circle(t + 0.4 * d).position).norm());
  }
  EXPECT_LT(worst, kThird / 6.0 * d * d * 2.0 * d) << "between the newest two of three that are d apart";
  EXPECT_GT(worst, 0.0);
}

// A program at 30 Hz does not make a peer at 60 Hz stop and go.
TEST(PoseFeed, MotionIsEvenBetweenPoses) {
  PoseFeed feed({}, kStale);
  const Vec3 v(3.0, 0.0, -1.0);
  std::optional<Vec3> last;
  for (int tick = 0; tick < 120; ++tick) {
    const double t = tick / 60.0;
    if (tick % 2 == 0) {
      ASSERT_TRUE(feed.push(after(t + 0.003), after(t), {.position = t * v}));
    }
    if (tick < 10) continue;
    const KinematicState s = feed.at(after(t));
    EXPECT_NEAR((s.velocity - v).norm(), 0.0, 1e-6);
    if (last) {
      EXPECT_NEAR((s.position - *last - v / 60.0).norm(), 0.0, 1e-6) << "tick " << tick;
    }
    last = s.position;
  }
}

TEST(PoseFeed, StandsAtItsPlaceBeforeTheFirstPose) {
  const Pose place{Vec3(1, 2, 3), Quat(Eigen::AngleAxisd(0.5, Vec3::UnitX()))};
  PoseFeed feed(place, kStale);
  EXPECT_FALSE(feed.begun());
  EXPECT_FALSE(feed.silent(after(100)));
  EXPECT_EQ(feed.at(after(0)).position, place.position);
  ASSERT_TRUE(feed.push(after(1), std::nullopt, {.position = Vec3(4, 5, 6)}));
  const KinematicState s = feed.at(after(1.01));
  EXPECT_EQ(s.position, Vec3(4, 5, 6));
  EXPECT_EQ(s.velocity, Vec3::Zero()) << "it was put there; that is no motion from its place";
  EXPECT_EQ(s.orientation.coeffs(), place.orientation.coeffs()) << "the pose has none, so it is unchanged";
}

TEST(PoseFeed, TheOrderOfArrivalDoesNotMatter) {
  std::vector<int> order(20);
  std::iota(order.begin(), order.end(), 0);
  PoseFeed in_order({}, kStale);
  for (const int i : order) {
    ASSERT_TRUE(in_order.push(after(0.5), after(0.02 * i), sample_of(circle(0.02 * i), Says::kPose)));
  }
  std::mt19937_64 random(7);
  for (int round = 0; round < 50; ++round) {
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
    PoseFeed shuffled({}, kStale);
    for (const int i : order) {
      ASSERT_TRUE(shuffled.push(after(0.5), after(0.02 * i), sample_of(circle(0.02 * i), Says::kPose)));
    }
    for (const double t : {-0.1, 0.0, 0.11, 0.38, 0.41, 1.5}) {
      const KinematicState a = in_order.at(after(t)), b = shuffled.at(after(t));
      EXPECT_EQ(a.position, b.position);
      EXPECT_EQ(a.velocity, b.velocity);
      EXPECT_EQ(a.orientation.coeffs(), b.orientation.coeffs());
    }
  }
}

TEST(PoseFeed, TimesBeyondTheirLimitsAreRefused) {
  PoseFeed feed({}, kStale);
  const auto push = [&](Duration stamp_minus_now) {
    const auto pushed = feed.push(after(10), after(10) + stamp_minus_now, {});
    return pushed ? std::string("taken") : to_string(pushed.error());
  };
  EXPECT_EQ(push(-kAgeMax), "taken");
  EXPECT_EQ(push(-kAgeMax - 1ns), "too_old");
  EXPECT_EQ(push(kAheadMax), "taken");
  EXPECT_EQ(push(kAheadMax + 1ns), "too_far_ahead");
  EXPECT_EQ(push(-1ms), "taken");
  EXPECT_EQ(push(-1ms), "duplicate");
  EXPECT_EQ(push(-kAgeMax), "duplicate");
  EXPECT_EQ(feed.push(after(10), std::nullopt, {}).has_value(), true);
  EXPECT_EQ(feed.push(after(10), std::nullopt, {}).error(), Refusal::kDuplicate);
}

struct Wrong {
  const char* name;
  PoseSample pose;
  std::optional<Refusal> refusal;
};
class Values : public testing::TestWithParam<Wrong> {};
TEST_P(Values, BeyondTheirLimitsAreRefused) {
  PoseFeed feed({}, kStale);
  const auto pushed = feed.push(after(1), std::nullopt, GetParam().pose);
  EXPECT_EQ(pushed ? std::nullopt : std::optional(pushed.error()), GetParam().refusal);
  EXPECT_EQ(feed.begun(), !GetParam().refusal);
}
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
INSTANTIATE_TEST_SUITE_P(
    Table, Values,
    testing::Values(Wrong{"Farthest", {.position = Vec3(1e9, 0, 0)}, {}},
                    Wrong{"TooFar", {.position = Vec3(1e9, 1e3, 0)}, Refusal::kPosition},
                    Wrong{"NoNumber", {.position = Vec3(0, kNaN, 0)}, Refusal::kPosition},
                    Wrong{"Infinite", {.position = Vec3(0, 0, -kInf)}, Refusal::kPosition},
                    Wrong{"FewDigits", {.orientation = Quat(0.71, 0.71, 0, 0)}, {}},
                    Wrong{"NoRotation", {.orientation = Quat(0, 0, 0, 0)}, Refusal::kOrientation},
                    Wrong{"Angles", {.orientation = Quat(0, 90, 0, 45)}, Refusal::kOrientation},
                    Wrong{"OrientationIsNoNumber", {.orientation = Quat(kNaN, 0, 0, 1)}, Refusal::kOrientation},
                    Wrong{"Fastest", {.velocity = Vec3(0, 1e6, 0)}, {}},
                    Wrong{"TooFast", {.velocity = Vec3(0, 1e6, 1e4)}, Refusal::kVelocity},
                    Wrong{"VelocityIsNoNumber", {.velocity = Vec3(kNaN, 0, 0)}, Refusal::kVelocity},
                    Wrong{"TooMuchAcceleration", {.acceleration = Vec3(2e6, 0, 0)}, Refusal::kAcceleration},
                    Wrong{"TooMuchSpin", {.angular_velocity_body = Vec3(0, 0, 2e4)}, Refusal::kSpin}),
    [](const auto& c) { return std::string(c.param.name); });

TEST(PoseFeed, AQuaternionOfFewDigitsIsMadeUnit) {
  PoseFeed feed({}, kStale);
  ASSERT_TRUE(feed.push(after(0), std::nullopt, {.orientation = Quat(0.71, 0.71, 0, 0)}));
  EXPECT_NEAR(feed.at(after(0)).orientation.norm(), 1.0, 1e-15);
}

TEST(PoseFeed, AMissingOrientationKeepsTheLastOne) {
  PoseFeed feed({}, kStale);
  const Quat turned(Eigen::AngleAxisd(0.5, Vec3::UnitX()));
  ASSERT_TRUE(feed.push(after(0), after(0), {.orientation = turned}));
  ASSERT_TRUE(feed.push(after(0.1), after(0.1), {.position = Vec3(1, 0, 0)}));
  const KinematicState s = feed.at(after(0.15));
  EXPECT_LT(s.orientation.angularDistance(turned), 1e-12);
  EXPECT_LT(s.angular_velocity_body.norm(), 1e-12);
}

// The object coasts for stale_s, then stands where it is; the next pose begins a new run.
TEST(PoseFeed, StandsWhenTheProgramFallsSilent) {
  PoseFeed feed({}, kStale);
  for (int i = 0; i <= 10; ++i)
    ASSERT_TRUE(feed.push(after(0.1 * i), after(0.1 * i), {.position = Vec3(0.2 * i, 0, 0)}));
  EXPECT_FALSE(feed.silent(after(1.5)));
  EXPECT_TRUE(feed.silent(after(1.5) + 1ns));
  EXPECT_NEAR(feed.at(after(1.5)).position.x(), 3.0, 1e-9);
  EXPECT_NEAR(feed.at(after(1.5)).velocity.x(), 2.0, 1e-9);
  for (const double t : {1.51, 2.0, 1000.0}) {
    EXPECT_NEAR(feed.at(after(t)).position.x(), 3.0, 1e-9);
    EXPECT_EQ(feed.at(after(t)).velocity, Vec3::Zero());
  }
  ASSERT_TRUE(feed.push(after(60), after(60), {.position = Vec3(10, 0, 0)}));
  EXPECT_FALSE(feed.silent(after(60)));
  EXPECT_EQ(feed.at(after(60.05)).position, Vec3(10, 0, 0));
  EXPECT_EQ(feed.at(after(60.05)).velocity, Vec3::Zero()) << "what was before the silence tells nothing";
  ASSERT_TRUE(feed.push(after(60.1), after(60.1), {.position = Vec3(10.5, 0, 0)}));
  EXPECT_NEAR(feed.at(after(60.1)).velocity.x(), 5.0, 1e-9);
}

// Without the rule, 200 m/s^2 would act for half a second: 25 m.
TEST(PoseFeed, AParabolaIsExtrapolatedAsFarAsItReachesBack) {
  PoseFeed feed({}, kStale);
  for (const double t : {0.0, 0.02, 0.04}) {
    ASSERT_TRUE(feed.push(after(t), after(t), {.position = Vec3(100.0 * t * t, 0, 0)}));
  }
  const KinematicState end = feed.at(after(0.08)), later = feed.at(after(0.48));
  EXPECT_NEAR(end.position.x(), 100.0 * 0.08 * 0.08, 1e-9);
  EXPECT_NEAR(later.position.x(), end.position.x() + 0.4 * 16.0, 1e-9) << "straight on with 16 m/s";
  EXPECT_EQ(later.acceleration, Vec3::Zero());
}

TEST(PoseFeed, AJumpIsNoMotion) {
  PoseFeed feed({}, kStale);
  for (const double t : {0.0, 0.1, 0.2}) ASSERT_TRUE(feed.push(after(t), after(t), {.position = Vec3(t, 0, 0)}));
  ASSERT_TRUE(feed.push(after(0.2), after(0.3), {.position = Vec3(500, 0, 0), .jump = true}));
  EXPECT_NEAR(feed.at(after(0.25)).position.x(), 0.25, 1e-9) << "not there yet, and not on the way";
  EXPECT_EQ(feed.at(after(0.3)).position.x(), 500);
  EXPECT_EQ(feed.at(after(0.35)).velocity, Vec3::Zero());
  ASSERT_TRUE(feed.push(after(0.4), after(0.4), {.position = Vec3(501, 0, 0)}));
  EXPECT_NEAR(feed.at(after(0.4)).velocity.x(), 10.0, 1e-9);
}

TEST(PoseFeed, ASpeedBeyondTheWireLimitsIsAnUnmarkedJump) {
  PoseFeed feed({}, kStale);
  for (const double t : {0.0, 0.02, 0.04}) {
    ASSERT_TRUE(feed.push(after(t), after(t), {.position = Vec3(t == 0.04 ? 1e9 : 0.0, 0, 0)}));
  }
  EXPECT_EQ(feed.at(after(0.05)).velocity, Vec3::Zero());
  EXPECT_EQ(feed.at(after(0.05)).position.x(), 1e9);
}

// Poses that need an acceleration beyond the limit are an unmarked jump, too, even if the speed at the last pose is
// zero.
TEST(PoseFeed, AccelerationsBeyondTheLimitAreNotBelieved) {
  for (const bool with_velocity : {false, true}) {
    PoseFeed feed({}, kStale);
    int i = 0;
    for (const double x : {-1e9, -2.5e8, 0.0}) {
      PoseSample p{.position = {x, 0, 0}, .orientation = Quat::Identity()};
      if (with_velocity) p.velocity = Vec3(1, 0, 0);
      const HostTime at = after(0.01 * i++);
      ASSERT_TRUE(feed.push(at, at, p));
    }
    const KinematicState s = feed.at(after(0.02));
    EXPECT_LE(s.acceleration.norm(), kAccelerationMax_m_s2);
    EXPECT_EQ(s.velocity, with_velocity ? Vec3(1, 0, 0) : Vec3(Vec3::Zero()));
  }
}

// A ball turns round at a wall: the states after the turn are not made of poses before it.
TEST(PoseFeed, AtASharpTurnTheNewestPosesCountAlone) {
  for (const bool with_velocity : {false, true}) {
    PoseFeed feed({}, kStale);
    const auto push = [&](double t, double x, double v) {
      PoseSample p{.position = Vec3(x, 0, 0)};
      if (with_velocity) p.velocity = Vec3(v, 0, 0);
      ASSERT_TRUE(feed.push(after(t), after(t), p));
    };
    push(0.00, 0.3, 10);
    push(0.02, 0.5, 10);
    push(0.04, 0.1, -20);
    const KinematicState s = feed.at(after(0.05));
    EXPECT_EQ(s.acceleration, Vec3::Zero());
    EXPECT_NEAR(s.position.x(), 0.1 - 0.01 * 20, 1e-9);
  }
  PoseFeed feed({}, kStale);
  ASSERT_TRUE(feed.push(after(0), after(0), {.position = Vec3(0, 0, 0), .velocity = Vec3(10, 0, 0)}));
  ASSERT_TRUE(feed.push(after(0.02), after(0.02), {.position = Vec3(0.2, 0, 0), .velocity = Vec3(-10, 0, 0)}));
  EXPECT_EQ(feed.at(after(0.03)).acceleration, Vec3::Zero());
  EXPECT_NEAR(feed.at(after(0.03)).position.x(), 0.1, 1e-9);
}

// 1 mm of noise at 1 kHz: over the millisecond between two poses it would be 2 m/s.
TEST(PoseFeed, NoiseIsNotMadeIntoVelocity) {
  PoseFeed feed({}, kStale);
  std::mt19937_64 random(5);
  double worst = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const double t = 0.001 * i, noise = 0.001 * (static_cast<double>(random() >> 11) * 0x1p-52 - 1.0);
    ASSERT_TRUE(feed.push(after(t), after(t), {.position = Vec3(t + noise, 0, 0)}));
    if (i > 100) worst = std::max(worst, std::abs(feed.at(after(t)).velocity.x() - 1.0));
  }
  EXPECT_LT(worst, 4.0 * 0.001 / to_seconds(PoseFeed::kSpacing)) << "weights 3/2, 2 and 1/2 over the spacing";
}

// Without times of their own, poses at 100 Hz that wait up to 8 ms seem 2 to 18 ms apart.
TEST(PoseFeed, QueuesAreNotMadeIntoVelocity) {
  const double j = 0.008, s = to_seconds(PoseFeed::kSpacingUnstamped);
  PoseFeed feed({}, kStale);
  double worst = 0.0;
  for (const Sent& sent : jittered(0.01, j, 20.0, 3)) {
    ASSERT_TRUE(feed.push(after(sent.heard_s), std::nullopt, {.position = Vec3(kSpeed * sent.sampled_s, 0, 0)}));
    if (sent.heard_s > 0.5) worst = std::max(worst, std::abs(feed.at(after(sent.heard_s)).velocity.x() - kSpeed));
  }
  // Positions are off by up to half of the motion within j (a constant delay does not matter), with weights of at most
  // 3/2, 2 and 1 over the spacing.
  EXPECT_LT(worst, 4.5 / s * 0.5 * kSpeed * j);
}

}  // namespace peerd::feed::pose_feed_test
