#include "peerd/peer/motion/flock.hpp"

#include <gtest/gtest.h>

#include "tests/peerd/path_checks.hpp"

namespace peerd::motion::flock_test {

constexpr PathTimes kTimes{-5.0, 60.0};

FlockSettings air() { return {.low = Vec3(-200, 30, -200), .high = Vec3(200, 120, 200)}; }
std::vector<Vec3> starts(int count) {
  std::vector<Vec3> all;
  for (int i = 0; i < count; ++i) all.emplace_back(8.0 * (i % 8), 60.0 + i % 3, 8.0 * (i / 8));
  return all;
}
bool same(const std::vector<std::vector<Knot>>& a, const std::vector<std::vector<Knot>>& b) {
  return std::ranges::equal(a, b, path_checks::same);
}

TEST(Flock, IsDeterminedByItsSeed) {
  const auto one = flock(air(), 7, starts(12), kTimes);
  EXPECT_TRUE(same(one, flock(air(), 7, starts(12), kTimes)));
  EXPECT_FALSE(same(one, flock(air(), 8, starts(12), kTimes)));
}

TEST(Flock, FliesTogetherWithinItsMeans) {
  const FlockSettings s = air();
  const auto birds = flock(s, 1, starts(48), kTimes);
  ASSERT_EQ(birds.size(), 48u);
  for (const auto& knots : birds) {
    EXPECT_EQ(knots.front().t_s, -5.0);
    EXPECT_GE(knots.back().t_s, 60.0);
    for (const Knot& k : knots) {
      ASSERT_LE(k.state.acceleration.norm(), s.acceleration_m_s2 + 1e-9);
      ASSERT_GT(k.state.velocity.norm(), 0.4 * s.speed_m_s);
      ASSERT_LT(k.state.velocity.norm(), 1.6 * s.speed_m_s);
      ASSERT_TRUE(((k.state.position - s.low).array() > -60.0).all() &&
                  ((s.high - k.state.position).array() > -60.0).all())
          << k.state.position.transpose() << ": goals are inside, so birds are about";
    }
  }
  // Once the birds have found each other, neighbours fly the same way, and no bird is inside another.
  double aligned = 0.0, nearest_sum = 0.0, count = 0.0;
  for (std::size_t step = 600; step < birds[0].size(); step += 60) {
    for (std::size_t i = 0; i < birds.size(); ++i) {
      double nearest = 1e9;
      std::size_t who = i;
      for (std::size_t j = 0; j < birds.size(); ++j) {
        const double d = (birds[i][step].state.position - birds[j][step].state.position).norm();
        if (j != i && d < nearest) nearest = d, who = j;
      }
      nearest_sum += nearest;
      aligned += birds[i][step].state.velocity.normalized().dot(birds[who][step].state.velocity.normalized());
      count += 1.0;
    }
  }
  EXPECT_GT(aligned / count, 0.98) << "0.92 to 0.96 where they only share goals";
  EXPECT_GT(nearest_sum / count, 0.7 * s.separation_m) << "0.1 without separation";
  EXPECT_LT(nearest_sum / count, 1.2 * s.separation_m);
}

TEST(Flock, EachMindsTheOthers) {
  const auto alone = flock(air(), 1, starts(1), kTimes);
  const auto together = flock(air(), 1, starts(2), kTimes);
  EXPECT_FALSE(path_checks::same(alone[0], together[0]));
}

TEST(Flock, LooksWhereItFliesAndIsSmooth) {
  const auto birds = flock(air(), 1, starts(12), kTimes);
  const MotionPath path(birds[4]);
  path_checks::expect_continuous(path);
  path_checks::expect_derivatives(path, -5.0, 60.0, 3000);
  for (double t = -5.0; t < 60.0; t += 0.013) {
    ASSERT_LT(path_checks::angle_from_velocity(path.sample(t)), 0.005) << t;
  }
}

}  // namespace peerd::motion::flock_test
