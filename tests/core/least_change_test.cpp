#include "core/least_change.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace peerd::least_change_test {

double energy(const std::vector<ConstrainedBody>& bodies) {
  double sum = 0.0;
  for (const ConstrainedBody& b : bodies) {
    if (b.inverse_mass > 0.0) sum += b.value.squaredNorm() / b.inverse_mass;
  }
  return sum;
}

TEST(LeastChange, LeavesWhatPartsAsItIs) {
  std::vector<ConstrainedBody> bodies = {{{1, 0, 0}, 1}, {{0.5, 0, 0}, 1}};
  EXPECT_TRUE(change_least(bodies, std::vector<OneSided>{{0, 1, Vec3::UnitX()}}).has_value());
  EXPECT_EQ(bodies[0].value, Vec3(1, 0, 0));
  EXPECT_EQ(bodies[1].value, Vec3(0.5, 0, 0));
}

TEST(LeastChange, SharesByMass) {
  std::vector<ConstrainedBody> bodies = {{{-4, 2, 0}, 1}, {{0, 0, 3}, 1.0 / 3}};
  EXPECT_TRUE(change_least(bodies, std::vector<OneSided>{{0, 1, Vec3::UnitX()}}).has_value());
  EXPECT_TRUE(bodies[0].value.isApprox(Vec3(-1, 2, 0), 1e-15));
  EXPECT_TRUE(bodies[1].value.isApprox(Vec3(-1, 0, 3), 1e-15));
}

// Three balls on each other on the floor: the floor bears the weight of all, and none falls.
TEST(LeastChange, BearsAStack) {
  std::vector<ConstrainedBody> bodies = {{{0, -10, 0}, 1}, {{0, -10, 0}, 1e-3}, {{0, -10, 0}, 1e3}, {{0, 0, 0}, 0}};
  const Vec3 up = Vec3::UnitY();
  EXPECT_TRUE(change_least(bodies, std::vector<OneSided>{{0, 3, up}, {1, 0, up}, {2, 1, up}}).has_value());
  for (const ConstrainedBody& b : bodies) EXPECT_EQ(b.value, Vec3::Zero());
}

// In a wedge of 90 degrees nothing is left, to the last bit, although no normal is exact.
TEST(LeastChange, RestsInAWedge) {
  const double s = std::sqrt(0.5);
  std::vector<ConstrainedBody> bodies = {{{0, -9.81, 0}, 1}, {{0, 0, 0}, 0}};
  EXPECT_TRUE(change_least(bodies, std::vector<OneSided>{{0, 1, {s, s, 0}}, {0, 1, {-s, s, 0}}}).has_value());
  EXPECT_EQ(bodies[0].value, Vec3::Zero());
}

TEST(LeastChange, TellsThatThereIsNoRoom) {
  const std::vector<ConstrainedBody> before = {{{0, 0, 0}, 1}, {{1, 0, 0}, 0}, {{-1, 0, 0}, 0}};
  std::vector<ConstrainedBody> bodies = before;
  const auto outcome = change_least(bodies, std::vector<OneSided>{{0, 1, Vec3::UnitX()}, {2, 0, Vec3::UnitX()}});
  EXPECT_EQ(outcome.error(), LeastChangeError::kNoRoom);
  for (std::size_t i = 0; i < bodies.size(); ++i) EXPECT_EQ(bodies[i].value, before[i].value);
}

// The same constraint several times, chains of any masses, and some large sets: what comes out satisfies all, and is no
// farther from what went in than anything else that does.
TEST(LeastChange, IsTheNearestOfAllThatSatisfyTheConstraints) {
  std::mt19937_64 rng(7);
  const auto unit = [&] { return static_cast<double>(rng() >> 11) * 0x1p-53; };
  const auto some = [&] { return Vec3(2 * unit() - 1, 2 * unit() - 1, 2 * unit() - 1); };
  int changed = 0, hidden = 0, hidden_of_many = 0;
  for (int run = 0; run < 2000; ++run) {
    const bool many = run % 20 == 19;
    std::vector<ConstrainedBody> bodies(2 + rng() % (many ? 30 : 5));
    for (ConstrainedBody& b : bodies) b = {some(), std::pow(10.0, 5.0 * unit() - 5.0)};
    bodies[0] = {Vec3::Zero(), 0.0};
    std::vector<OneSided> constraints;
    for (std::size_t i = 0, count = 1 + rng() % (many ? 90 : 12); i < count; ++i) {
      const auto a = static_cast<std::uint32_t>(rng() % bodies.size());
      const auto b = static_cast<std::uint32_t>((a + 1 + rng() % (bodies.size() - 1)) % bodies.size());
      const bool again = !constraints.empty() && rng() % 4 == 0;
      constraints.push_back(again ? constraints[rng() % constraints.size()] : OneSided{a, b, some().normalized()});
    }
    const std::vector<ConstrainedBody> before = bodies;
    if (!change_least(bodies, constraints)) {  // rounding hides the solution
      ++(many ? hidden_of_many : hidden);
      continue;
    }
    EXPECT_LE(energy(bodies), energy(before) * (1 + 1e-12)) << run;
    const bool satisfied = std::ranges::all_of(
        constraints, [&](const OneSided& c) { return c.normal.dot(bodies[c.a].value - bodies[c.b].value) >= -1e-9; });
    if (!satisfied) {
      ++(many ? hidden_of_many : hidden);
      continue;
    }
    // The change is orthogonal, by mass, to what is left: the mark of the nearest point of a cone.
    double product = 0.0, size = 0.0;
    for (std::size_t i = 1; i < bodies.size(); ++i) {
      product += (before[i].value - bodies[i].value).dot(bodies[i].value) / bodies[i].inverse_mass;
      size += before[i].value.squaredNorm() / bodies[i].inverse_mass;
      changed += before[i].value != bodies[i].value ? 1 : 0;
    }
    EXPECT_LE(std::abs(product), 1e-9 * size) << run;
  }
  EXPECT_GT(changed, 1000);
  EXPECT_LE(hidden, 4);
  EXPECT_LE(hidden_of_many, 6);
}

TEST(LeastChange, WhatIsHeldTogetherDoesNotPart) {
  std::vector<ConstrainedBody> bodies{{Vec3(1, 5, 0), 1.0}, {Vec3(-2, 0, 0), 0.5}};
  const OneSided held{0, 1, Vec3::UnitX(), 0.0, true};
  const auto multipliers = change_least(bodies, std::array{held});
  ASSERT_TRUE(multipliers);
  EXPECT_NEAR((*multipliers)[0], -2.0, 1e-15);  // they part at 3 m/s, and have 1 kg and 2 kg
  EXPECT_TRUE(bodies[0].value.isApprox(Vec3(-1, 5, 0), 1e-15));
  EXPECT_TRUE(bodies[1].value.isApprox(Vec3(-1, 0, 0), 1e-15));
}

TEST(LeastChange, LeavesAsMuchApproachAsAllowed) {
  std::vector<ConstrainedBody> bodies{{Vec3(-3, 0, 0), 1.0}, {Vec3::Zero(), 0.0}};
  const auto slow = change_least(bodies, std::array{OneSided{0, 1, Vec3::UnitX(), -1.0}});
  ASSERT_TRUE(slow);
  EXPECT_EQ((*slow)[0], 2.0);
  EXPECT_EQ(bodies[0].value, Vec3(-1, 0, 0));
  EXPECT_EQ((*change_least(bodies, std::array{OneSided{0, 1, Vec3::UnitX(), -1.0}}))[0], 0.0);
}

// The multipliers alone say whether a solution is the least change: the conditions of Karush, Kuhn and Tucker.
TEST(LeastChange, OfBoundsAndHeldPairs) {
  std::mt19937_64 rng(11);
  const auto unit = [&] { return static_cast<double>(rng() >> 11) * 0x1p-53; };
  const auto some = [&] { return Vec3(2 * unit() - 1, 2 * unit() - 1, 2 * unit() - 1); };
  int hidden = 0, pulls = 0, at_bound = 0;
  for (int run = 0; run < 500; ++run) {
    std::vector<ConstrainedBody> bodies(2 + rng() % 20);
    for (ConstrainedBody& b : bodies) b = {some(), 0.5 + unit()};
    bodies[0] = {Vec3::Zero(), 0.0};
    std::vector<OneSided> constraints;
    for (std::size_t i = 0, count = 1 + rng() % 40; i < count; ++i) {
      const auto a = static_cast<std::uint32_t>(rng() % bodies.size());
      const auto b = static_cast<std::uint32_t>((a + 1 + rng() % (bodies.size() - 1)) % bodies.size());
      const bool held = rng() % 5 == 0;
      constraints.push_back({a, b, some().normalized(), held || rng() % 2 == 0 ? 0.0 : -unit(), held});
    }
    const std::vector<ConstrainedBody> before = bodies;
    const auto multipliers = change_least(bodies, constraints);
    if (!multipliers) {
      ++hidden;
      continue;
    }
    std::vector<Vec3> after;
    for (const ConstrainedBody& b : before) after.push_back(b.value);
    double most = 1.0;
    for (std::size_t i = 0; i < constraints.size(); ++i) {
      const OneSided& c = constraints[i];
      const double by = (*multipliers)[i];
      most = std::max(most, std::abs(by));
      after[c.a] += by * before[c.a].inverse_mass * c.normal;
      after[c.b] -= by * before[c.b].inverse_mass * c.normal;
      EXPECT_TRUE(c.is_held || by >= 0.0) << run;
      pulls += by < 0.0 ? 1 : 0;
      const double over = c.normal.dot(bodies[c.a].value - bodies[c.b].value) - c.least;
      EXPECT_GE(over, -1e-9) << run;
      if (by != 0.0 || c.is_held) {
        EXPECT_LE(over, 1e-9) << run;
      }
      at_bound += by > 0.0 && c.least < 0.0 ? 1 : 0;
    }
    for (std::size_t i = 0; i < bodies.size(); ++i) EXPECT_LE((bodies[i].value - after[i]).norm(), 1e-9 * most) << run;
  }
  EXPECT_LE(hidden, 5);
  EXPECT_GT(pulls, 200);
  EXPECT_GT(at_bound, 200);
}

}  // namespace peerd::least_change_test
