#include "core/least_change.hpp"

#include <gtest/gtest.h>

#include <algorithm>
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

}  // namespace peerd::least_change_test
