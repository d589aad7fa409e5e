#include "peerd/lab/measure/statistics/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace peerd::measure::statistics_test {

TEST(Statistics, HandNumbers) {
  const Statistics s = statistics({3.0, 1.0, 2.0, 6.0});
  EXPECT_EQ(s.count, 4u);
  EXPECT_DOUBLE_EQ(s.mean, 3.0);
  EXPECT_DOUBLE_EQ(s.rms, std::sqrt(50.0 / 4.0));
  EXPECT_DOUBLE_EQ(s.p99, 6.0);
  EXPECT_DOUBLE_EQ(s.max, 6.0);
}

TEST(Statistics, NothingIsZeroNotNan) {
  const Statistics s = statistics({});
  EXPECT_EQ(s.count, 0u);
  EXPECT_EQ(s.mean, 0.0);
  EXPECT_EQ(s.rms, 0.0);
  EXPECT_EQ(s.p99, 0.0);
  EXPECT_EQ(s.max, 0.0);
}

TEST(Statistics, MaxOfNegativesIsNegative) { EXPECT_EQ(statistics({-3.0, -1.0}).max, -1.0); }

struct RankCase {
  std::size_t count;
  double p99;  // p99 of the samples 1, 2, .. count
};
class NearestRank : public testing::TestWithParam<RankCase> {};
TEST_P(NearestRank, IsTheLeastThat99PercentDoNotExceed) {
  std::vector<double> samples;
  for (std::size_t i = 1; i <= GetParam().count; ++i) samples.push_back(static_cast<double>(i));
  std::ranges::shuffle(samples, std::mt19937(7));
  EXPECT_EQ(statistics(samples).p99, GetParam().p99);
}
INSTANTIATE_TEST_SUITE_P(Table, NearestRank,
                         testing::Values(RankCase{1, 1}, RankCase{2, 2}, RankCase{99, 99}, RankCase{100, 99},
                                         RankCase{101, 100}, RankCase{200, 198}, RankCase{900, 891}));

TEST(Integral, TrapezoidsOfUnevenSteps) {
  const std::vector<TimedValue> samples{{1.0, 2.0}, {2.0, 4.0}, {4.0, 0.0}};
  EXPECT_DOUBLE_EQ(integral(samples), 3.0 + 4.0);
  EXPECT_EQ(integral(std::span(samples).first(1)), 0.0);
  EXPECT_EQ(integral({}), 0.0);
}

}  // namespace peerd::measure::statistics_test
