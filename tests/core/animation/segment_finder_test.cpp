#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "core/animation/animation.hpp"
#include "core/math.hpp"

namespace peerd::animation::segment_finder_test {

using Floats = std::vector<float>;
constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr auto kFloat = FieldType::kFloat;
constexpr auto kVec3 = FieldType::kVec3;
constexpr auto kRotation = FieldType::kRotation;

// The network has a sensor, a ScalarInterpolator in between, a position and an orientation.
Network network(const TimeSensorFields& sensor, Floats ease_key, Floats ease, Floats key, Floats p, Floats r) {
  return {{sensor, Interpolator{InterpolatorType::kScalar, std::move(ease_key), std::move(ease)},
           Interpolator{InterpolatorType::kPosition, key, std::move(p)},
           Interpolator{InterpolatorType::kOrientation, key, std::move(r)}, PlainNode{}},
          {{0, "fraction_changed", 1, "set_fraction", kFloat},
           {1, "value_changed", 2, "set_fraction", kFloat},
           {1, "value_changed", 3, "set_fraction", kFloat},
           {2, "value_changed", 4, "translation", kVec3},
           {3, "value_changed", 4, "rotation", kRotation}}};
}

TEST(Segment, SaysWhereTheMovementBendsAndHowFastItIs) {
  Animation a(network({10, true, true, 2, 0}, {0, 1}, {0, 1}, {0, 0.5, 1}, {0, 0, 0, 5, 0, 0, 5, 10, 0},
                      {0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 1, 3}));
  const FieldId translation = *a.field(4, "translation");
  const FieldId rotation = *a.field(4, "rotation");

  const Segment before = *a.segment(translation, 0.5);
  EXPECT_TRUE(before.initial);
  EXPECT_EQ(before.end_s, 2.0);

  const Segment first = *a.segment(translation, 2.0);
  EXPECT_FALSE(first.initial);
  EXPECT_EQ(first.begin_s, 2.0);
  EXPECT_EQ(first.end_s, 7.0);
  EXPECT_EQ(first.position, Vec3(0, 0, 0));
  EXPECT_EQ(first.velocity, Vec3(1, 0, 0));

  const Segment second = *a.segment(translation, 7.0);
  EXPECT_EQ(second.begin_s, 7.0);
  EXPECT_EQ(second.end_s, 12.0);
  EXPECT_EQ(second.position, Vec3(5, 0, 0));
  EXPECT_EQ(second.velocity, Vec3(0, 2, 0));

  // The field has the last value at the end of a cycle; the segment is the movement that follows.
  EXPECT_EQ(a.segment(translation, 12.0)->position, Vec3(0, 0, 0));
  Value v;
  ASSERT_TRUE(a.value(translation, 12.0, v));
  EXPECT_EQ(v.vec3(), Vec3(5, 10, 0));

  const Segment turn = *a.segment(rotation, 8.0);
  EXPECT_LT((turn.angular_velocity_body - Vec3(0, 0, 0.4)).norm(), 1e-7);
  EXPECT_LT(angle_between(turn.orientation_at(9.5), quat_exp({0, 0, 2})), 1e-7);
}

TEST(Segment, EndsNeverWhereNothingComes) {
  Animation a(network({10, true, false, 2, 0}, {0, 1}, {0, 1}, {0, 1}, {0, 0, 0, 5, 0, 0}, {0, 0, 1, 0, 0, 0, 1, 1}));
  const Segment s = *a.segment(*a.field(4, "translation"), 50.0);
  EXPECT_TRUE(s.is_constant);
  EXPECT_EQ(s.begin_s, 12.0);
  EXPECT_EQ(s.end_s, kNever);
  EXPECT_EQ(s.position_at(1e9), Vec3(5, 0, 0));
  EXPECT_EQ(a.deliver(60, 4, "translation", Value::of_vec3({1, 2, 3})), std::nullopt);
  EXPECT_EQ(a.segment(*a.field(4, "translation"), 50.0)->end_s, 60.0);
  EXPECT_EQ(a.segment(*a.field(4, "translation"), 61.0)->position, Vec3(1, 2, 3));
}

// Segments are followed along whole lives: they are gapless, go forwards, and agree with value() to the stated bound.
TEST(Segment, AgreesWithValueToTheStatedBound) {
  std::mt19937 random(17);
  std::uniform_real_distribution<float> unit(0, 1);
  double worst = 0.0;
  double worst_turn = 0.0;
  for (int world = 0; world < 300; ++world) {
    const auto keys = [&](int n) {
      Floats k(n);
      for (float& x : k) x = unit(random);
      std::ranges::sort(k);
      if (n > 3 && world % 3 == 0) k[1] = k[2];
      if (world % 2) k.front() = 0, k.back() = 1;
      return k;
    };
    const auto numbers = [&](int n, float size) {
      Floats v(n);
      for (float& x : v) x = size * (2 * unit(random) - 1);
      return v;
    };
    const int n = 1 + static_cast<int>(5 * unit(random));
    const int m = 1 + static_cast<int>(4 * unit(random));
    Floats ease = numbers(m, 1);
    for (float& x : ease) x = std::abs(x);
    const double start_s = world % 5 ? 10 * unit(random) : 1e5 + unit(random);
    const double interval = 0.5 + 5 * unit(random);
    const Floats a_keys = keys(n);
    Animation a(network({interval, true, world % 4 != 0, start_s, world % 4 == 1 ? start_s + 13 * unit(random) : 0},
                        keys(m), ease, a_keys, numbers(3 * n, 100), numbers(4 * n, 3)),
                {start_s - 1});
    float gap = 1;
    for (std::size_t k = 1; k < a_keys.size(); ++k) {
      if (a_keys[k] > a_keys[k - 1]) gap = std::min(gap, a_keys[k] - a_keys[k - 1]);
    }
    const double chain = 2e-16 / gap;  // movement of a piece times the rounding of the fraction
    const FieldId fields[] = {*a.field(4, "translation"), *a.field(4, "rotation")};
    for (const FieldId field : fields) {
      double t = start_s - 0.5;
      Value v;
      for (int i = 0; i < 100 && t < kNever; ++i) {
        const auto s = a.segment(field, t);
        ASSERT_TRUE(s);
        ASSERT_LE(s->begin_s, t);
        ASSERT_GT(s->end_s, t);
        const double end = std::min(s->end_s, t + 20.0);
        for (const double part : {0.001, 0.3, 0.5, 0.8, 0.999}) {
          const double at = t + part * (end - t);
          if (!(at > s->begin_s && at < end)) continue;
          ASSERT_EQ(a.value(field, at, v), !s->initial);
          if (s->initial) continue;
          const double jitter = 2.0 * (std::nextafter(end, kNever) - end) + 2e-16 * interval;
          if (field == fields[0]) {
            const double bound = 2e-15 * 100 + 350 * chain + jitter * s->velocity.norm();
            const double error = (v.vec3() - s->position_at(at)).norm();
            ASSERT_LE(error, bound) << world << ' ' << at;
            worst = std::max(worst, error / bound);
          } else {
            const double bound = 2e-15 + std::numbers::pi * chain + jitter * s->angular_velocity_body.norm();
            const double error = angle_between(v.quat(), s->orientation_at(at));
            ASSERT_LE(error, bound) << world << ' ' << at;
            worst_turn = std::max(worst_turn, error / bound);
          }
        }
        t = s->end_s;
      }
    }
  }
  std::printf("segment against value: %.2f of the bound for positions, %.2f for orientations\n", worst, worst_turn);
}

TEST(Segment, OfWhatASegmentCannotSayIsNone) {
  Animation a({{TimeSensorFields{4, true, true, 0, 0},
                Interpolator{InterpolatorType::kColor, Floats{0, 0.5}, Floats{1, 0, 0, 0, 1, 0}}, PlainNode{}},
               {{0, "fraction_changed", 1, "set_fraction", kFloat},
                {1, "value_changed", 2, "diffuseColor", FieldType::kColor}}});
  EXPECT_FALSE(a.segment(*a.field(2, "diffuseColor"), 1));
  const auto still = a.segment(*a.field(2, "diffuseColor"), 3);
  ASSERT_TRUE(still);
  EXPECT_TRUE(still->is_constant);
  EXPECT_EQ(still->end_s, 4.0);
}

}  // namespace peerd::animation::segment_finder_test
