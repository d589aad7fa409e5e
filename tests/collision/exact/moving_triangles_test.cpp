#include "collision/exact/moving_triangles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "tests/collision/oracle_types.hpp"
#include "tests/collision/soups.hpp"

namespace peerd::collision::moving_triangles_test {

constexpr double kTolerance_m = 1e-6;

struct Pair {
  MovingTriangle a, b;
};

MovingTriangle moving(const Triangle& at_0, const Triangle& at_1) {
  return {MovingPoint{at_0[0], at_1[0]}, MovingPoint{at_0[1], at_1[1]}, MovingPoint{at_0[2], at_1[2]}};
}
MovingTriangle moved(const Triangle& t, const Vec3& by) { return moving(t, {t[0] + by, t[1] + by, t[2] + by}); }

// What the table says of the pair's first contact: never where `time` is below 0.
struct Case {
  const char* name;
  Pair pair;
  double time;
};
const Triangle kFloor = {Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};
const Triangle kTipDown = {Vec3(1, 1, 1), Vec3(2, 1, 3), Vec3(1, 2, 3)};
const Triangle kAbove = {Vec3(0, 0, 1), Vec3(4, 0, 1), Vec3(0, 4, 1)};
const Triangle kBesideInPlane = {Vec3(-3, 1, 0), Vec3(-2, 1, 0), Vec3(-2, 2, 0)};
const Triangle kPoint = {Vec3(1, 1, 2), Vec3(1, 1, 2), Vec3(1, 1, 2)};
MovingTriangle still(const Triangle& t) { return moved(t, Vec3::Zero()); }

class FirstImpact : public testing::TestWithParam<Case> {};
TEST_P(FirstImpact, IsThatOfTheTable) {
  const auto& [name, pair, time] = GetParam();
  MovingTriangleQuery query;
  for (const std::uint32_t max_steps : {512u, 0u}) {
    const MovingTriangleOptions options{.max_steps = max_steps};
    const LinearImpact impact = query.first_impact(pair.a, pair.b, options);
    if (time < 0.0) {
      EXPECT_EQ(impact.state, ImpactState::kSeparated);
      continue;
    }
    EXPECT_EQ(impact.state, ImpactState::kHit);
    EXPECT_LE(impact.time, time);
    EXPECT_NEAR(impact.time, time, 2e-6);
    const LinearImpact swapped = query.first_impact(pair.b, pair.a, options);
    EXPECT_EQ(swapped.state, impact.state);
    EXPECT_EQ(swapped.time, impact.time);
  }
}
INSTANTIATE_TEST_SUITE_P(
    Table, FirstImpact,
    testing::Values(
        Case{"Still", {still(kFloor), still(kTipDown)}, -1},
        Case{"AtBegin", {still(kFloor), moved(kFloor, {0, 0, 1})}, 0},
        Case{"CrossingAtBegin",
             {still({Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)}),
              still({Vec3(1, 1, -3), Vec3(1, 1, 3), Vec3(9, 9, 3)})},
             0},
        Case{"CornerFalls", {still(kFloor), moved(kTipDown, {0, 0, -2})}, 0.5},
        Case{"BothMove", {moved(kFloor, {0, 0, 1}), moved(kTipDown, {0, 0, -1})}, 0.5},
        Case{"AtTheEnd", {still(kFloor), moved(kTipDown, {0, 0, -1})}, 1},
        Case{"NotQuite", {still(kFloor), moved(kTipDown, {0, 0, -0.999})}, -1},
        Case{"PassesBy", {still(kFloor), moved(kTipDown, {8, 0, -2})}, -1},
        Case{"Parallel", {still(kFloor), moved(kAbove, {0, 0, -4})}, 0.25},
        Case{"ParallelAbove", {still(kFloor), moved(kAbove, {3, 1, 0})}, -1},
        Case{"InThePlane", {still(kFloor), moved(kBesideInPlane, {4, 0, 0})}, 0.5},
        Case{"APoint", {still(kFloor), moved(kPoint, {0, 0, -8})}, 0.25},
        Case{"TwoPoints", {still(kPoint), moved({Vec3(1, 1, 0), Vec3(1, 1, 0), Vec3(1, 1, 0)}, {0, 0, 4})}, 0.5},
        Case{"Shears", {still(kFloor), moving(kTipDown, {Vec3(1, 1, -1), Vec3(9, 1, 3), Vec3(1, 9, 3)})}, 0.5}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(MovingTriangles, WhatIsLaterThanAskedForIsNone) {
  MovingTriangleQuery query;
  const MovingTriangle floor = still(kFloor), falls = moved(kTipDown, {0, 0, -2});
  const double time = query.first_impact(floor, falls).time;
  EXPECT_EQ(query.first_impact(floor, falls, {.last = time}).time, time);
  EXPECT_EQ(query.first_impact(floor, falls, {.last = time}).state, ImpactState::kHit);
  EXPECT_EQ(query.first_impact(floor, falls, {.last = 0.499}).state, ImpactState::kSeparated);
}

// Families of pairs, each from seeded numbers.

Triangle random_triangle(Numbers& numbers, double size) {
  const Vec3 p = numbers.point(size), q = numbers.point(size);
  return {p, q, numbers.point(size)};
}
Triangle shifted(const Triangle& t, const Vec3& by) { return {t[0] + by, t[1] + by, t[2] + by}; }

Pair any(Numbers& numbers) {
  const MovingTriangle a = moving(random_triangle(numbers, 1), random_triangle(numbers, 1));
  return {a, moving(random_triangle(numbers, 1), random_triangle(numbers, 1))};
}
Pair approaching(Numbers& numbers) {
  const Vec3 aside = numbers.point(0.8) + Vec3(3, 0, 0), by = numbers.point(1.0) - Vec3(4, 0, 0);
  const MovingTriangle a = moved(random_triangle(numbers, 1), numbers.point(0.5));
  return {a, moved(shifted(random_triangle(numbers, 1), aside), by)};
}
Pair at_rest(Numbers& numbers) {
  const MovingTriangle a = still(random_triangle(numbers, 1));
  return {a, still(shifted(random_triangle(numbers, 1), numbers.point(1.0)))};
}
Triangle needle(Numbers& numbers) {
  const Vec3 p = numbers.point(1), q = numbers.point(1);
  return {p, q, p + (q - p) * numbers.unit() + numbers.point(1e-9)};
}
Pair needles(Numbers& numbers) {
  const MovingTriangle a = moving(needle(numbers), needle(numbers));
  const bool both = numbers.unit() < 0.5;
  return {a, moved(shifted(both ? needle(numbers) : random_triangle(numbers, 1), {2, 0, 0}),
                   numbers.point(1) - Vec3(3, 0, 0))};
}
Pair far_away(Numbers& numbers) {
  Pair pair = numbers.unit() < 0.5 ? any(numbers) : approaching(numbers);
  const Vec3 place = numbers.point(1.0).normalized() * 1e6;
  for (MovingTriangle* t : {&pair.a, &pair.b}) {
    for (MovingPoint& p : *t) {
      p.at_0 += place;
      p.at_1 += place;
    }
  }
  return pair;
}
// A corner passes an edge at a distance between none and a few tolerances.
Pair grazing(Numbers& numbers) {
  const double distances[] = {0.0, 1e-12, 1e-9, 0.5e-6, 0.99e-6, 1.01e-6, 1.7e-6, 3e-6};
  const double off = distances[static_cast<std::size_t>(numbers.unit() * 8)] * (numbers.unit() < 0.5 ? 1 : -1);
  const Triangle edge = {Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(numbers.between(-1, 1), -1, numbers.between(-0.5, 0.5))};
  const Vec3 passes(std::round(numbers.between(-4, 4)) / 8, off, 0);
  const Triangle tip = {passes, passes + Vec3(0.5, 1, 0.25), passes + Vec3(-0.5, 1, numbers.between(-1, 1))};
  const Vec3 by(std::round(numbers.between(-8, 8)) / 8, 0, numbers.unit() < 0.5 ? 2 : 0.0625);
  const Vec3 half = by / 2;
  return {still(edge), moved(shifted(tip, Vec3(-half)), by)};
}
// Faces in parallel planes: stacked, sliding, or a little tilted.
Pair parallel(Numbers& numbers) {
  Triangle a = random_triangle(numbers, 1), b = random_triangle(numbers, 1);
  for (std::size_t i = 0; i < 3; ++i) {
    a[i].z() = 0.0;
    b[i].z() = 0.5 + (numbers.unit() < 0.25 ? numbers.between(0, 1e-8) : 0.0);
  }
  const double down = numbers.unit() < 0.3 ? 0.0 : numbers.between(-2.0, 0.5);
  const Quat turn = quat_exp(numbers.point(2.0));
  for (Vec3& p : a) p = turn * p;
  for (Vec3& p : b) p = turn * p;
  return {still(a), moved(b, turn * Vec3(numbers.between(-1, 1), numbers.between(-1, 1), down))};
}
Pair in_one_plane(Numbers& numbers) {
  const MovingTriangle a = moved(random_triangle(numbers, 1), numbers.point(1));
  const MovingTriangle b = moved(shifted(random_triangle(numbers, 1), {2.5, 0, 0}), numbers.point(1) - Vec3(2, 0, 0));
  Pair pair{a, b};
  for (MovingTriangle* t : {&pair.a, &pair.b}) {
    for (MovingPoint& p : *t) p.at_0.z() = p.at_1.z() = 0.0;
  }
  return pair;
}
// Rigid turns about an axis, as the chord of a step.
MovingTriangle turned(Numbers& numbers, const Vec3& place) {
  const Triangle t = random_triangle(numbers, 0.8);
  const Quat before = quat_exp(numbers.point(2.0)), by = quat_exp(numbers.point(0.3));
  const Vec3 move = numbers.point(0.5);
  Triangle at_0, at_1;
  for (std::size_t i = 0; i < 3; ++i) {
    at_0[i] = before * t[i] + place;
    at_1[i] = by * (before * t[i]) + place + move;
  }
  return moving(at_0, at_1);
}
Pair tumbling(Numbers& numbers) {
  const MovingTriangle a = turned(numbers, Vec3::Zero());
  return {a, turned(numbers, {1, 0, 0})};
}
// Hardly any gap, and hardly any motion.
Pair resting(Numbers& numbers) {
  const double gap = std::pow(10.0, numbers.between(-9, -5));
  Triangle b = random_triangle(numbers, 1);
  const double lowest = std::min({b[0].z(), b[1].z(), b[2].z()});
  for (Vec3& p : b) p.z() += gap - lowest;
  const Triangle floor = {Vec3(-9, -9, 0), Vec3(9, -9, 0), Vec3(0, 9, 0)};
  return {still(floor), moved(b, {numbers.between(-1, 1), numbers.between(-1, 1), numbers.between(-1, 0.5) * 1e-6})};
}
Pair segments_and_points(Numbers& numbers) {
  Pair pair = numbers.unit() < 0.5 ? approaching(numbers) : any(numbers);
  pair.a[2] = pair.a[0];
  if (numbers.unit() < 0.5) pair.b[2] = pair.b[1];
  if (numbers.unit() < 0.25) pair.b[0] = pair.b[1] = pair.b[2];
  return pair;
}
// Two sides that share corners with a neighbour in a tissue: points are equal at times.
Pair meeting_corners(Numbers& numbers) {
  Pair pair = approaching(numbers);
  pair.b[0].at_1 = pair.a[0].at_1;
  if (numbers.unit() < 0.5) pair.b[1].at_1 = pair.a[1].at_1;
  return pair;
}

struct Family {
  const char* name;
  Pair (*make)(Numbers&);
};
constexpr Family kFamilies[] = {{"any", any},
                                {"approaching", approaching},
                                {"at_rest", at_rest},
                                {"needles", needles},
                                {"far_away", far_away},
                                {"grazing", grazing},
                                {"parallel", parallel},
                                {"in_one_plane", in_one_plane},
                                {"tumbling", tumbling},
                                {"resting", resting},
                                {"segments_and_points", segments_and_points},
                                {"meeting_corners", meeting_corners}};

double distance_m(const oracle::MovingTriangle& a, const oracle::MovingTriangle& b, double time) {
  return std::sqrt(oracle::squared_distance_at(a, b, mpq_class(time)).get_d());
}

struct Figures {
  int queries = 0, hits = 0, contacts = 0, unsure = 0;
  double worst_m = 0.0;  // distance at the time of a hit
};

void check_against_oracle(const Pair& pair, const MovingTriangleOptions& options, MovingTriangleQuery& query,
                          Figures& figures) {
  const oracle::MovingTriangle a = plain(pair.a), b = plain(pair.b);
  const auto truth = oracle::first_touch(a, b);
  const LinearImpact impact = query.first_impact(pair.a, pair.b, options);
  ++figures.queries;
  figures.contacts += truth.has_value();
  if (truth) {
    ASSERT_NE(impact.state, ImpactState::kSeparated);
    ASSERT_LE(mpq_class(impact.time), truth->at_latest);
  }
  if (impact.state == ImpactState::kUnsure) ++figures.unsure;
  if (impact.state == ImpactState::kHit) {
    ++figures.hits;
    const double gap_m = distance_m(a, b, impact.time);
    figures.worst_m = std::max(figures.worst_m, gap_m);
    ASSERT_LE(gap_m, std::sqrt(3.0) * kTolerance_m);
  }
  const LinearImpact swapped = query.first_impact(pair.b, pair.a, options);
  ASSERT_EQ(swapped.state, impact.state);
  ASSERT_EQ(swapped.time, impact.time);
}

class MovingTriangleFamilies : public testing::TestWithParam<Family> {};
TEST_P(MovingTriangleFamilies, AreNeverLateAndEarlyByTheToleranceAtMost) {
  MovingTriangleQuery query;
  Numbers numbers(101);
  Figures figures;
  for (int i = 0; i < 250; ++i) {
    const Pair pair = GetParam().make(numbers);
    ASSERT_NO_FATAL_FAILURE(check_against_oracle(pair, {}, query, figures)) << i;
  }
  EXPECT_EQ(figures.unsure, 0);
  EXPECT_GT(figures.contacts, 10);
  // Advancement by directions stops at a distance, not at one along each axis.
  EXPECT_LE(figures.worst_m, kTolerance_m);
  RecordProperty("queries", figures.queries);
  RecordProperty("hits", figures.hits);
  RecordProperty("contacts", figures.contacts);
  RecordProperty("worst_earliness_pm", static_cast<int>(figures.worst_m * 1e12));
}
TEST_P(MovingTriangleFamilies, AreNeverLateByInclusionAlone) {
  MovingTriangleQuery query;
  Numbers numbers(102);
  Figures figures;
  for (int i = 0; i < 60; ++i) {
    const Pair pair = GetParam().make(numbers);
    const MovingTriangleOptions options{.max_steps = 0, .max_iterations = 1u << 10};
    ASSERT_NO_FATAL_FAILURE(check_against_oracle(pair, options, query, figures)) << i;
  }
  RecordProperty("unsure", figures.unsure);
  RecordProperty("worst_earliness_pm", static_cast<int>(figures.worst_m * 1e12));
}
TEST_P(MovingTriangleFamilies, StayFartherApartThanTheMarginBefore) {
  MovingTriangleQuery query;
  Numbers numbers(103);
  for (int i = 0; i < 60; ++i) {
    const Pair pair = GetParam().make(numbers);
    const oracle::MovingTriangle a = plain(pair.a), b = plain(pair.b);
    const double margin = i % 3 == 0 ? 1e-5 : i % 3 == 1 ? 0.01 : 0.3;
    const LinearImpact impact = query.first_impact(
        pair.a, pair.b, {.margin_m = margin, .max_steps = i % 10 == 0 ? 0u : 512u, .max_iterations = 1u << 10});
    const double end = impact.state == ImpactState::kSeparated ? 1.0 : impact.time;
    for (int sample = 0; sample <= 16; ++sample) {
      const double t = end * sample / 16;
      if (sample == 16 && impact.state != ImpactState::kSeparated) break;
      if (end == 0.0) break;
      ASSERT_GT(oracle::squared_distance_at(a, b, mpq_class(t)), mpq_class(margin) * margin) << i << " at " << t;
    }
    if (impact.state != ImpactState::kHit) continue;
    ASSERT_LE(distance_m(a, b, impact.time), std::sqrt(3.0) * (margin + kTolerance_m)) << i;
  }
}
INSTANTIATE_TEST_SUITE_P(Seeded, MovingTriangleFamilies, testing::ValuesIn(kFamilies),
                         [](const auto& test) { return std::string(test.param.name); });

// Lengths far from one metre: what is certain stays certain, and no number overflows.
TEST(MovingTriangles, AreNeverLateAtAnyScale) {
  MovingTriangleQuery query;
  Numbers numbers(104);
  for (const double scale : {0x1p-300, 0x1p-60, 0x1p-20, 0x1p20, 0x1p60, 0x1p126}) {
    for (int i = 0; i < 60; ++i) {
      Pair pair = i % 2 == 0 ? any(numbers) : approaching(numbers);
      for (MovingTriangle* t : {&pair.a, &pair.b}) {
        for (MovingPoint& p : *t) {
          p.at_0 *= scale;
          p.at_1 *= scale;
        }
      }
      const auto truth = oracle::first_touch(plain(pair.a), plain(pair.b));
      const LinearImpact impact = query.first_impact(pair.a, pair.b, {.tolerance_m = 1e-6 * scale});
      ASSERT_EQ(impact.state != ImpactState::kSeparated, truth.has_value()) << scale << ", " << i;
      if (truth) {
        ASSERT_LE(mpq_class(impact.time), truth->at_latest) << scale << ", " << i;
      }
    }
  }
}

// The steps of the advancement, and at most one iteration of each of the 15 inclusion tests.
TEST(MovingTriangles, IterationsAreThoseOfBothSearches) {
  constexpr std::uint32_t kSteps = 16;
  MovingTriangleQuery query;
  Numbers numbers(105);
  std::uint32_t most = 0;
  for (const Family& family : kFamilies) {
    for (int i = 0; i < 60; ++i) {
      const Pair pair = family.make(numbers);
      const LinearImpact impact = query.first_impact(pair.a, pair.b, {.max_steps = kSteps, .max_iterations = 1});
      ASSERT_LE(impact.iterations, kSteps + 15) << family.name << ", " << i;
      most = std::max(most, impact.iterations);
    }
  }
  EXPECT_GT(most, kSteps);
}

TEST(FirstBoxContact, IsWhereBoxesMeet) {
  const MovingTriangle floor = still(kFloor);
  const auto time = first_box_contact(floor, moved(kTipDown, {0, 0, -2}));
  ASSERT_TRUE(time);
  EXPECT_LE(*time, 0.5);
  EXPECT_NEAR(*time, 0.5, 1e-12);
  EXPECT_EQ(first_box_contact(floor, still(kFloor)), 0.0);
  EXPECT_FALSE(first_box_contact(floor, still(kTipDown)));
  EXPECT_TRUE(first_box_contact(floor, still(kTipDown), 1.0));
  // It has passed before it is down.
  EXPECT_FALSE(first_box_contact(floor, moved(shifted(kTipDown, {-3, 0, 0}), {100, 0, -2})));
}

}  // namespace peerd::collision::moving_triangles_test
