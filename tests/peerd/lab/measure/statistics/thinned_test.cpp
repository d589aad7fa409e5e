#include "peerd/lab/measure/statistics/thinned.hpp"

#include <gtest/gtest.h>

namespace peerd::measure::thinned_test {

TEST(Thinned, KeepsAllRowsThatFit) {
  Thinned<int> kept(10);
  for (int i = 0; i < 10; ++i) kept.add(static_cast<std::uint64_t>(i), i);
  EXPECT_EQ(kept.stride(), 1u);
  EXPECT_EQ(kept.take().size(), 10u);
}

TEST(Thinned, KeepsEveryNthRowOfEachSeries) {
  Thinned<int> kept(100);
  for (int i = 0; i < 1000; ++i) {
    for (int series = 0; series < 5; ++series) kept.add(static_cast<std::uint64_t>(i), 10'000 * series + i);
  }
  const auto stride = static_cast<int>(kept.stride());
  const std::vector<int> rows = kept.take();
  EXPECT_LE(rows.size(), 100u);
  EXPECT_GT(rows.size(), 50u - 5u);
  EXPECT_EQ(stride, 64);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i], 10'000 * static_cast<int>(i % 5) + static_cast<int>(i / 5) * stride);
  }
}

TEST(Thinned, KeepsTheFirstRowOfEachSeriesWhereThereAreTooMany) {
  Thinned<int> kept(10);
  for (int i = 0; i < 50; ++i) {
    for (int series = 0; series < 100; ++series) kept.add(static_cast<std::uint64_t>(i), series);
  }
  const std::vector<int> rows = kept.take();
  EXPECT_LE(rows.size(), 400u);
  for (int series = 0; series < 100; ++series) EXPECT_EQ(rows[static_cast<std::size_t>(series)], series);
}

}  // namespace peerd::measure::thinned_test
