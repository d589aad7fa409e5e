#include "collision/contact/deforming_contact.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>

#include "collision/exact/triangle_pair.hpp"
#include "tests/allocation_counter.hpp"
#include "tests/collision/oracle_types.hpp"
#include "tests/collision/soups.hpp"

namespace peerd::collision::deforming_contact_test {

struct Moving {
  std::vector<Vec3> at_begin, at_end;
  std::vector<TriangleSoup::Face> faces;
  [[nodiscard]] SoupStep step() const { return {at_begin, at_end, faces}; }
};

Moving moved(const TriangleSoup& soup, const Affine& begin, const Affine& end) {
  Moving out{{}, {}, soup.faces};
  for (const Vec3& p : soup.vertices) {
    out.at_begin.push_back(begin.linear * p + begin.offset);
    out.at_end.push_back(end.linear * p + end.offset);
  }
  return out;
}
Affine shift(const Vec3& by) { return {Mat3::Identity(), by}; }

// The answer by all pairs of triangles.
SoupImpact brute_force(const SoupStep& a, const SoupStep& b, const SoupImpactOptions& options) {
  MovingTriangleQuery query;
  OrientationCounters counters;
  std::optional<SoupImpact> best;
  const auto rank = [](const SoupImpact& i) {
    const bool touching = i.state == SoupImpactState::kTouching;
    return std::tuple(!touching, i.fraction, i.state, i.polygons, i.faces);
  };
  for (std::uint32_t i = 0; i < a.faces.size(); ++i) {
    for (std::uint32_t j = 0; j < b.faces.size(); ++j) {
      SoupImpact next{.polygons = {a.faces[i].polygon, b.faces[j].polygon}, .faces = {i, j}};
      const LinearImpact pair = query.first_impact(a.triangle(i), b.triangle(j),
                                                   {.margin_m = options.margin_m,
                                                    .tolerance_m = options.tolerance_m,
                                                    .max_steps = options.max_steps,
                                                    .max_iterations = options.max_iterations});
      next.fraction = pair.time;
      if (touch(a.triangle_at_begin(i), b.triangle_at_begin(j), counters)) {
        next.state = SoupImpactState::kTouching;
        next.fraction = 0.0;
      } else if (pair.state == ImpactState::kSeparated) {
        continue;
      } else {
        next.state = pair.state == ImpactState::kHit ? SoupImpactState::kHit : SoupImpactState::kUnsure;
      }
      if (!best || rank(next) < rank(*best)) best = next;
    }
  }
  return best.value_or(SoupImpact{});
}

void expect_same(const SoupImpact& found, const SoupImpact& expected) {
  ASSERT_EQ(found.state, expected.state);
  ASSERT_EQ(found.fraction, expected.fraction);
  ASSERT_EQ(found.polygons, expected.polygons);
  ASSERT_EQ(found.faces, expected.faces);
}

TEST(DeformingContact, ACubeFallsOnACube) {
  const TriangleSoup soup = closed_box({0.5, 0.5, 0.5});
  SoupImpactQuery query;
  const Moving below = moved(soup, shift({0, 0, 0}), shift({0, 0, 0}));
  const Moving falls = moved(soup, shift({0.25, 3, 0.25}), shift({0.25, -1, 0.25}));
  const SoupImpact impact = query.first_impact(falls.step(), below.step());
  EXPECT_EQ(impact.state, SoupImpactState::kHit);
  EXPECT_LE(impact.fraction, 0.5);
  EXPECT_NEAR(impact.fraction, 0.5, 1e-6);
  // The sides of the cube reach its lower face, and come first: the least of all pairs with that fraction.
  expect_same(impact, brute_force(falls.step(), below.step(), {}));
  EXPECT_TRUE(query.touching_at_begin().empty());
  const Moving passes = moved(soup, shift({1.01, 3, 0}), shift({1.01, -3, 0}));
  EXPECT_EQ(query.first_impact(passes.step(), below.step()).state, SoupImpactState::kSeparated);
  EXPECT_EQ(query.first_impact(passes.step(), below.step(), {.margin_m = 0.02}).state, SoupImpactState::kHit);
  const Moving inside =
      moved(soup, Affine{0.5 * Mat3::Identity(), Vec3::Zero()}, Affine{0.5 * Mat3::Identity(), Vec3::Zero()});
  EXPECT_EQ(query.first_impact(inside.step(), below.step()).state, SoupImpactState::kSeparated);
}

TEST(DeformingContact, TouchingAtTheBeginIsExact) {
  const TriangleSoup soup = closed_box({0.5, 0.5, 0.5});
  SoupImpactQuery query;
  const Moving below = moved(soup, shift({0, 0, 0}), shift({0, 0, 0}));
  const Moving on = moved(soup, shift({0.25, 1, 0.25}), shift({0.25, 3, 0.25}));
  const SoupImpact impact = query.first_impact(on.step(), below.step());
  EXPECT_EQ(impact.state, SoupImpactState::kTouching);
  EXPECT_EQ(impact.fraction, 0.0);
  expect_same(impact, brute_force(on.step(), below.step(), {}));
  EXPECT_FALSE(query.touching_at_begin().empty());
  EXPECT_EQ(query.touching_at_begin().front(), impact.faces);
}

// A gap of one unit in the last place, far below the tolerance.
TEST(DeformingContact, WhatPartsOrSlidesIsNoContact) {
  const TriangleSoup soup = closed_box({0.5, 0.5, 0.5});
  SoupImpactQuery query;
  const Moving below = moved(soup, shift({0, 0, 0}), shift({0, 0, 0}));
  const Vec3 above(0.25, 1 + 0x1p-52, 0.25);
  const Quat turn = quat_exp({0.3, 0.2, 0.1});
  struct Case {
    double gap_m;
    Vec3 by;
    SoupImpactState state;
  };
  for (const auto& [gap_m, by, state] :
       {Case{1e-9, {0, 2, 0}, SoupImpactState::kSeparated}, Case{1e-9, {0.3, 0, 0.2}, SoupImpactState::kSeparated},
        Case{1e-9, {0, -2, 0}, SoupImpactState::kHit}, Case{1e-9, {0.3, -1e-6, 0}, SoupImpactState::kHit}}) {
    const auto map = [&](const Vec3& place) { return Affine{turn.toRotationMatrix(), turn * place}; };
    const Vec3 from(0.25, 1.0 + gap_m, 0.25);
    const SoupImpact impact = query.first_impact(moved(soup, map(from), map(from + by)).step(),
                                                 moved(soup, map({0, 0, 0}), map({0, 0, 0})).step());
    EXPECT_EQ(impact.state, state) << by.transpose();
    if (state == SoupImpactState::kHit) {
      EXPECT_LE(impact.fraction, gap_m / -by.y());
    }
    const Moving straight = moved(soup, shift(above), shift(above + by));
    EXPECT_EQ(query.first_impact(straight.step(), below.step()).state, state) << by.transpose();
  }
}

TEST(DeformingContact, EmptySoupsTouchNothing) {
  const TriangleSoup soup = closed_box({0.5, 0.5, 0.5});
  const Moving still = moved(soup, {}, {});
  SoupImpactQuery query;
  EXPECT_EQ(query.first_impact(SoupStep{}, still.step()).state, SoupImpactState::kSeparated);
  EXPECT_EQ(query.first_impact(still.step(), SoupStep{}).state, SoupImpactState::kSeparated);
}

Affine random_map(Numbers& numbers, const Vec3& place) {
  Affine map{quat_exp(numbers.point(2.0)).toRotationMatrix(), place};
  for (int k = 0; k < 3; ++k) map.linear.col(k) += numbers.point(0.3);
  return map;
}

TEST(DeformingContact, IsTheLeastOfAllPairs) {
  SoupImpactQuery query;
  Numbers numbers(141);
  int hits = 0, touching = 0, separated = 0;
  for (int i = 0; i < 120; ++i) {
    const TriangleSoup of_a = random_soup(20 + i % 30, 0.3, 1000 + i),
                       of_b = i % 5 == 0 ? torus(6, 8, true) : random_soup(40, 0.2, 2000 + i);
    const double away = i % 4 == 0 ? 1.5 : 3.5;
    const Vec3 from = numbers.point(1.0).normalized() * away;
    Moving a = moved(of_a, random_map(numbers, from), random_map(numbers, from * numbers.between(-0.2, 0.8)));
    Moving b = moved(of_b, random_map(numbers, Vec3::Zero()), random_map(numbers, numbers.point(0.5)));
    if (i % 3 == 0) {
      for (Vec3& p : a.at_end) p += numbers.point(0.5);  // a deformation that no matrix makes
    }
    const SoupImpactOptions options{.margin_m = i % 2 == 0 ? 0.0 : 0.02};
    const SoupImpact impact = query.first_impact(a.step(), b.step(), options);
    ASSERT_NO_FATAL_FAILURE(expect_same(impact, brute_force(a.step(), b.step(), options))) << i;
    hits += impact.state == SoupImpactState::kHit;
    touching += impact.state == SoupImpactState::kTouching;
    separated += impact.state == SoupImpactState::kSeparated;
    const SoupImpact swapped = query.first_impact(b.step(), a.step(), options);
    ASSERT_EQ(swapped.state, impact.state) << i;
    ASSERT_EQ(swapped.fraction, impact.fraction) << i;
  }
  EXPECT_GT(hits, 30);
  EXPECT_GT(touching, 5);
  EXPECT_GT(separated, 10);
}

// Two cubes tumble towards each other in steps of chords. Rational arithmetic says of each step when they first touch.
TEST(DeformingContact, TumblingCubesMeetWhenTheOracleSaysSo) {
  const TriangleSoup soup = closed_box({0.5, 0.5, 0.5});
  SoupImpactQuery query;
  Numbers numbers(142);
  int contacts = 0, steps = 0;
  double worst_m = 0.0;
  for (int run = 0; run < 12; ++run) {
    const Vec3 spin_a = numbers.point(3.0), spin_b = numbers.point(3.0), aside = numbers.point(0.7);
    const Vec3 place = run % 3 == 0 ? Vec3(1e6, -3e5, 2e5) : Vec3::Zero();
    const auto map = [&](const Vec3& spin, const Vec3& from, const Vec3& velocity, int step) {
      const double t = step / 10.0;
      return Affine{quat_exp(spin * t).toRotationMatrix(), place + from + velocity * t};
    };
    for (int step = 0; step < 10; ++step) {
      const Moving a =
          moved(soup, map(spin_a, {0, 0, 0}, {0.5, 0, 0}, step), map(spin_a, {0, 0, 0}, {0.5, 0, 0}, step + 1));
      const Vec3 from = Vec3(2.5, 0, 0) + aside;
      const Moving b = moved(soup, map(spin_b, from, {-2, 0, 0}, step), map(spin_b, from, {-2, 0, 0}, step + 1));
      const SoupImpact impact = query.first_impact(a.step(), b.step());
      ++steps;
      std::optional<mpq_class> truth;
      for (std::uint32_t i = 0; i < 12; ++i) {
        for (std::uint32_t j = 0; j < 12; ++j) {
          const MovingTriangle of_a = a.step().triangle(i), of_b = b.step().triangle(j);
          if (!boxes_near(swept_box(of_a), swept_box(of_b), 0.0)) continue;
          const auto first = oracle::first_touch(plain(of_a), plain(of_b));
          if (first && (!truth || first->at_latest < *truth)) truth = first->at_latest;
        }
      }
      ASSERT_NE(impact.state, SoupImpactState::kUnsure);
      if (impact.state == SoupImpactState::kSeparated) {
        ASSERT_FALSE(truth) << run << ", " << step;
        continue;
      }
      if (truth) {
        ASSERT_LE(mpq_class(impact.fraction), *truth) << run << ", " << step;
      }
      const double gap_m =
          std::sqrt(oracle::squared_distance_at(plain(a.step().triangle(impact.faces.a)),
                                                plain(b.step().triangle(impact.faces.b)), mpq_class(impact.fraction))
                        .get_d());
      worst_m = std::max(worst_m, gap_m);
      ASSERT_LE(gap_m, 1e-6) << run << ", " << step;
      ++contacts;
      break;
    }
  }
  EXPECT_GT(contacts, 6);
  RecordProperty("steps", steps);
  RecordProperty("worst_earliness_pm", static_cast<int>(worst_m * 1e12));
}

#if PEERD_COUNTS_ALLOCATIONS
TEST(DeformingContact, AQuestionLikeOneBeforeAllocatesNothing) {
  const TriangleSoup of_a = torus(12, 24, true), of_b = random_soup(200, 0.1, 143);
  SoupImpactQuery query;
  std::vector<std::pair<Moving, Moving>> steps;
  Numbers numbers(144);
  for (int i = 0; i < 20; ++i) {
    steps.emplace_back(moved(of_a, random_map(numbers, {3, 0, 0}), random_map(numbers, {0.5, 0, 0})),
                       moved(of_b, random_map(numbers, Vec3::Zero()), random_map(numbers, Vec3::Zero())));
  }
  std::uint64_t candidates = 0;
  const auto ask = [&] {
    for (const auto& [a, b] : steps) candidates += query.first_impact(a.step(), b.step()).candidates;
  };
  ask();
  const long before = allocations();
  ask();
  EXPECT_EQ(allocations(), before);
  EXPECT_GT(candidates, 100u);
}
#endif

}  // namespace peerd::collision::deforming_contact_test
