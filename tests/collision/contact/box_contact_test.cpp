#include "collision/contact/box_contact.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/collision/shapes.hpp"

namespace peerd::collision::box_contact_test {

using namespace test;

KinematicState spinning(KinematicState state, const Vec3& spin_rad_s) {
  state.angular_velocity_body = spin_rad_s;
  return state;
}

// An end of several bodies.
class End {
 public:
  End& add(Body body, const KinematicState& motion) {
    bodies_.push_back(std::move(body));
    motions_.push_back(motion);
    return *this;
  }
  [[nodiscard]] std::vector<MovingBody> at(double s = 0.0) const {
    advanced_.clear();
    for (const KinematicState& motion : motions_) advanced_.push_back(advance(motion, s));
    std::vector<MovingBody> moving;
    for (std::size_t i = 0; i < bodies_.size(); ++i) moving.push_back({bodies_[i], advanced_[i]});
    return moving;
  }
  // The box of all vertices s later, by nothing but their positions.
  struct Extents {
    std::array<double, 3> low, high;
  };
  [[nodiscard]] Extents extents(double s) const {
    constexpr double kFar = std::numeric_limits<double>::infinity();
    Extents e{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const Pose pose = advance(motions_[i], s).pose();
      for (const Vec3& v : bodies_[i].vertices()) {
        const Vec3 p = pose * v;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          e.low[axis] = std::min(e.low[axis], p[static_cast<int>(axis)]);
          e.high[axis] = std::max(e.high[axis], p[static_cast<int>(axis)]);
        }
      }
    }
    return e;
  }

 private:
  std::vector<Body> bodies_;
  std::vector<KinematicState> motions_;
  mutable std::vector<KinematicState> advanced_;
};

double gap_of(const End& a, const End& b, double s) {
  const End::Extents of_a = a.extents(s), of_b = b.extents(s);
  double greatest = -std::numeric_limits<double>::infinity();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    greatest = std::max({greatest, of_a.low[axis] - of_b.high[axis], of_b.low[axis] - of_a.high[axis]});
  }
  return greatest;
}

End one(const KinematicState& motion) { return End().add(box(1, 1, 1), motion); }

// A second box of the same end goes ahead of the first one.
End two(const KinematicState& first, const KinematicState& second) {
  return End().add(box(1, 1, 1), first).add(box(1, 1, 1), second);
}

constexpr double kEighth_rad = std::numbers::pi / 4;

// ---- by hand ----

struct Case {
  const char* name;
  End a, b;
  double horizon_s, margin_m;
  ContactState state;
  double time_s;
  Vec3 normal = Vec3::Zero();
};
class FirstBoxContact : public testing::TestWithParam<Case> {};

TEST_P(FirstBoxContact, IsAsComputedByHand) {
  const Case& c = GetParam();
  const Contact found = first_box_contact(c.a.at(), c.b.at(), c.horizon_s, c.margin_m);
  ASSERT_EQ(found.state, c.state);
  if (c.state == ContactState::kSeparated) return;
  EXPECT_LE(found.time_s, c.time_s);
  EXPECT_NEAR(found.time_s, c.time_s, 2e-5);
  EXPECT_EQ(found.normal_world, c.normal);
  const Contact swapped = first_box_contact(c.b.at(), c.a.at(), c.horizon_s, c.margin_m);
  EXPECT_EQ(swapped.state, found.state);
  EXPECT_EQ(swapped.time_s, found.time_s);
  EXPECT_EQ(swapped.normal_world, Vec3(-found.normal_world));
}

INSTANTIATE_TEST_SUITE_P(
    Table, FirstBoxContact,
    testing::Values(Case{"Approaches", one(moving({0, 0, 0}, {2, 0, 0})), one(moving({5, 0.3, 0})), 10, 0,
                         ContactState::kContact, 2.0, -Vec3::UnitX()},
                    Case{"StopsShort", one(moving({0, 0, 0}, {2, 0, 0})), one(moving({5, 0, 0})), 1.9, 0,
                         ContactState::kSeparated, 0},
                    Case{"PassesBy", one(moving({0, 0, 0}, {2, 0, 0})), one(moving({5, 1.1, 0})), 10, 0,
                         ContactState::kSeparated, 0},
                    Case{"Accelerates", one(moving({0, 9, 0}, {0, 0, 0}, {0, -2, 0})), one(moving({0, 4, 0})), 10, 0,
                         ContactState::kContact, 2.0, Vec3::UnitY()},
                    Case{"ComesBack", one(moving({0, 0, 0}, {-1, 0, 0}, {2, 0, 0})), one(moving({3, 0, 0})), 10, 0,
                         ContactState::kContact, 2.0, -Vec3::UnitX()},
                    Case{"TurnsBeforeItTouches", one(moving({0, 0, 0}, {2, 0, 0}, {-1, 0, 0})),
                         one(moving({3.1, 0, 0})), 10, 0, ContactState::kSeparated, 0},
                    Case{"LastAxisIsTheNormal", one(moving({0, 0, 0}, {1.5, 0, 1})), one(moving({3, 0, 3})), 10, 0,
                         ContactState::kContact, 2.0, -Vec3::UnitZ()},
                    Case{"SecondBodyIsAhead", two(moving({0, 0, 0}, {1, 0, 0}), moving({1, 0, 0}, {3, 0, 0})),
                         one(moving({8, 0, 0})), 10, 0, ContactState::kContact, 2.0, -Vec3::UnitX()},
                    // Neither of the two is where the other end is, and the box around both of them is.
                    Case{"BoxOfTwoThatAreBesides", two(moving({0, -2, 0}, {2, 0, 0}), moving({0, 2, 0}, {2, 0, 0})),
                         one(moving({5, 0, 0})), 10, 0, ContactState::kContact, 2.0, -Vec3::UnitX()},
                    Case{"TouchesAtZero", one(moving({0, 0, 0}, {2, 0, 0})), one(moving({1, 0, 0})), 10, 0,
                         ContactState::kContact, 0, -Vec3::UnitX()},
                    Case{"OverlapsAtZero", one(moving({0, 0, 0}, {2, 0, 0})), one(moving({0.75, 0, 0})), 10, 0,
                         ContactState::kOverlapped, 0, -Vec3::UnitX()},
                    // The corner is at 45 degrees first, and turns towards the other box.
                    Case{"CornerComesAround", one(spinning(moving({0, 0, 0}), {0, 0, 0.5})),
                         one(moving({0.5 + std::sqrt(0.5) * std::cos(kEighth_rad - 0.5), 0, 0})), 10, 0,
                         ContactState::kContact, 1.0, -Vec3::UnitX()}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(BoxGap, IsTheGreatestOfTheAxes) {
  EXPECT_DOUBLE_EQ(box_gap_m(one(moving({0, 0, 0})).at(), one(moving({4, 2, 0})).at()), 3.0);
  EXPECT_DOUBLE_EQ(box_gap_m(one(moving({0, 0, 0})).at(), one(moving({0.75, 0.5, 0})).at()), -0.25);
  EXPECT_DOUBLE_EQ(box_gap_m(two(moving({0, 0, 0}), moving({2, 0, 0})).at(), one(moving({4, 0, 0})).at()), 1.0);
}

TEST(BoxGap, WhatHasNoVerticesMeetsNothing) {
  const End nothing = End().add(Body{}, moving({0, 0, 0})), cube = one(moving({0, 0, 0}));
  EXPECT_EQ(box_gap_m(nothing.at(), cube.at()), std::numeric_limits<double>::infinity());
  EXPECT_EQ(first_box_contact(nothing.at(), cube.at(), 10, 0).state, ContactState::kSeparated);
  EXPECT_EQ(first_box_contact(cube.at(), nothing.at(), 10, 0).state, ContactState::kSeparated);
  const End with_more = End().add(Body{}, moving({9, 9, 9})).add(box(1, 1, 1), moving({0.5, 0, 0}));
  EXPECT_LT(box_gap_m(with_more.at(), cube.at()), 0.0) << "only its vertices count";
}

// ---- any motions, against the boxes themselves ----

End random_end(std::mt19937_64& rng, const Vec3& around) {
  End end;
  std::uniform_real_distribution<float> size(0.2F, 1.0F);
  const int bodies = 1 + static_cast<int>(rng() % 3);
  for (int i = 0; i < bodies; ++i) {
    const float x = size(rng), y = size(rng);
    KinematicState motion = moving(around + random_vector(rng, 1.0), random_vector(rng, 2.0), random_vector(rng, 2.0));
    motion.orientation = random_rotation(rng);
    if (rng() % 2 == 0) motion.angular_velocity_body = random_vector(rng, 4.0);
    end.add(box(x, y, size(rng)), motion);
  }
  return end;
}

// Until its contact time the two are farther apart than half of the margin, and then no farther than margin and
// tolerance.
TEST(FirstBoxContact, IsNeverLateAndEarlyByAMicrometreAtMost) {
  constexpr double kHorizon_s = 2.0, kMargins_m[] = {0.0, 1e-3};
  constexpr int kSteps = 1000;
  std::mt19937_64 rng(5);
  int met = 0, passed = 0;
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    const End a = random_end(rng, {-2, 0, 0}), b = random_end(rng, {2, 0, 0});
    const double margin_m = kMargins_m[i % 2];
    const Contact found = first_box_contact(a.at(), b.at(), kHorizon_s, margin_m);
    if (gap_of(a, b, 0.0) <= margin_m + kAdvancementTolerance_m) continue;
    ASSERT_TRUE(found.state == ContactState::kContact || found.state == ContactState::kSeparated);
    const bool contact = found.state == ContactState::kContact;
    const double clear_s = contact ? found.time_s : kHorizon_s;
    for (int k = 0; k <= kSteps; ++k) ASSERT_GT(gap_of(a, b, clear_s * k / kSteps), 0.5 * margin_m - 1e-12) << "late";
    ++(contact ? met : passed);
    if (!contact) continue;
    EXPECT_LE(gap_of(a, b, found.time_s), margin_m + kAdvancementTolerance_m + 1e-12) << "early";
    EXPECT_EQ(first_box_contact(b.at(), a.at(), kHorizon_s, margin_m).time_s, found.time_s);
    // The same question, asked at a later instant, has the same answer but for the tolerance.
    const double later_s = 0.5 * found.time_s;
    const Contact again = first_box_contact(a.at(later_s), b.at(later_s), kHorizon_s - later_s, margin_m);
    ASSERT_EQ(again.state, ContactState::kContact);
    EXPECT_LE(gap_of(a, b, later_s + again.time_s), margin_m + kAdvancementTolerance_m + 1e-12);
  }
  EXPECT_GT(met, 40);
  EXPECT_GT(passed, 40);
}

TEST(BoxesOverlapFor, IsATimeForWhichTheyCertainlyOverlap) {
  constexpr double kHorizon_s = 1.0;
  std::mt19937_64 rng(6);
  int overlapping = 0;
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE(i);
    const End a = random_end(rng, {0, 0, 0}), b = random_end(rng, {0.5, 0, 0});
    const double lasts_s = boxes_overlap_for_s(a.at(), b.at(), kHorizon_s);
    ASSERT_GE(lasts_s, 0.0);
    ASSERT_LE(lasts_s, kHorizon_s);
    if (gap_of(a, b, 0.0) >= 0.0) {
      EXPECT_EQ(lasts_s, 0.0);
      continue;
    }
    ++overlapping;
    EXPECT_GT(lasts_s, 0.0);
    double truly_s = kHorizon_s;
    for (int k = 0; k <= 200; ++k) {
      const double s = kHorizon_s * k / 200;
      if (gap_of(a, b, s) > 1e-12) {
        truly_s = s;
        break;
      }
    }
    EXPECT_LE(lasts_s, truly_s);
  }
  EXPECT_GT(overlapping, 500);
}

TEST(BoxesOverlapFor, LastsUntilTheEndWhereNothingParts) {
  const End a = two(moving({0, 0, 0}), moving({1, 0, 0}));
  EXPECT_EQ(boxes_overlap_for_s(a.at(), one(moving({0.5, 0, 0})).at(), 7.0), 7.0);
  // 0.5 m deep, at 2 m/s.
  EXPECT_DOUBLE_EQ(boxes_overlap_for_s(one(moving({0, 0, 0}, {-2, 0, 0})).at(), one(moving({0.5, 0, 0})).at(), 7.0),
                   0.25);
}

}  // namespace peerd::collision::box_contact_test
