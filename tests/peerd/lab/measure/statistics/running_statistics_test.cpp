#include "peerd/lab/measure/statistics/running_statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace peerd::measure::running_statistics_test {

void expect_same(const Statistics& running, const Statistics& kept) {
  EXPECT_EQ(running.count, kept.count);
  EXPECT_EQ(running.mean, kept.mean);
  EXPECT_EQ(running.rms, kept.rms);
  EXPECT_EQ(running.p99, kept.p99);
  EXPECT_EQ(running.max, kept.max);
  EXPECT_TRUE(running.p99_exact);
}

TEST(RunningStatistics, AreThoseOfAllSamplesToTheBit) {
  std::mt19937 random(3);
  std::exponential_distribution<double> any;
  for (const std::size_t count : {0u, 1u, 2u, 99u, 100u, 101u, 199u, 200u, 1800u, 10'000u}) {
    RunningStatistics running(count + 500);  // fewer may come than were announced
    std::vector<double> all;
    for (std::size_t i = 0; i < count; ++i) {
      all.push_back(i % 3 == 0 ? 0.0 : any(random));
      running.add(all.back());
    }
    SCOPED_TRACE(count);
    expect_same(running.result(), statistics(all));
  }
}

TEST(RunningStatistics, SamplesThatAreAlmostAllZeroHaveAP99OfZero) {
  RunningStatistics running(1000);
  for (int i = 0; i < 1000; ++i) running.add(i < 10 ? 5.0 : 0.0);
  EXPECT_EQ(running.result().p99, 0.0);
  EXPECT_EQ(running.result().max, 5.0);
}

// Errors that grow, that shrink, and that are drawn at random: the greatest samples come last, first or anywhere.
TEST(RunningStatistics, BeyondAMillionTheP99IsWithinItsBound) {
  constexpr std::size_t kCount = RunningStatistics::kExactSamples + 50'000;
  std::mt19937 random(5);
  std::lognormal_distribution<double> drawn(0.0, 3.0);
  for (const int kind : {0, 1, 2}) {
    RunningStatistics running(2 * kCount);
    std::vector<double> all;
    for (std::size_t i = 0; i < kCount; ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(kCount);
      all.push_back(kind == 0 ? std::exp(20.0 * share) : kind == 1 ? 1e-6 / (share + 1e-6) : drawn(random));
      running.add(all.back());
      if (i + 1 != RunningStatistics::kExactSamples) continue;
      SCOPED_TRACE("at a million");
      expect_same(running.result(), statistics(all));
    }
    const Statistics exact = statistics(all), found = running.result();
    EXPECT_FALSE(found.p99_exact);
    EXPECT_NEAR(found.p99, exact.p99, RunningStatistics::kP99Error * exact.p99) << kind;
    EXPECT_EQ(found.mean, exact.mean);
    EXPECT_EQ(found.rms, exact.rms);
    EXPECT_EQ(found.max, exact.max);
  }
}

}  // namespace peerd::measure::running_statistics_test
