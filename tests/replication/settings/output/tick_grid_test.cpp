#include "replication/settings/output/tick_grid.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::tick_grid_test {

using namespace test;

class Grid : public testing::TestWithParam<std::uint32_t> {};

// The numbers are those around the epoch and around fifty years after it.
TEST_P(Grid, ATicksTimeGivesTheTickBackAndTheNanosecondBeforeGivesTheOneBefore) {
  const TickGrid grid(GetParam());
  for (const std::int64_t around : {std::int64_t{0}, std::int64_t{50} * 365 * 86'400 * GetParam()}) {
    for (std::int64_t number = around - 300; number <= around + 300; ++number) {
      const SimTime at = grid.time_of(number);
      ASSERT_EQ(grid.number_at(at), number);
      ASSERT_EQ(grid.number_at(at - 1ns), number - 1);
      ASSERT_LT(at, grid.time_of(number + 1));
    }
  }
}

TEST_P(Grid, WholeSecondsAreTicks) {
  TickGrid grid(GetParam());
  const std::int64_t hz = GetParam();
  for (const std::int64_t s : {-3, -1, 0, 1, 7}) {
    EXPECT_EQ(grid.time_of(s * hz), sim(std::chrono::seconds(s)));
    grid.set_last(s * hz);
    EXPECT_TRUE(grid.begins_a_second());
    if (hz == 1) continue;
    grid.set_last(s * hz + 1);
    EXPECT_FALSE(grid.begins_a_second());
    grid.set_last(s * hz - 1);
    EXPECT_FALSE(grid.begins_a_second());
  }
}
INSTANTIATE_TEST_SUITE_P(Rates, Grid, testing::Values(1u, 3u, 7u, 60u, 144u, 1000u),
                         [](const auto& hz) { return std::to_string(hz.param) + "Hz"; });

TEST(TickGrid, TimesAreRoundedDownToWholeNanoseconds) {
  const TickGrid grid(60);
  EXPECT_EQ(grid.time_of(1), sim(16'666'666ns));
  EXPECT_EQ(grid.time_of(2), sim(33'333'333ns));
  EXPECT_EQ(grid.time_of(-1), sim(-16'666'667ns));
}

TEST(TickGrid, KnowsTheLastTickAndTheNext) {
  TickGrid grid(4);
  EXPECT_EQ(grid.last(), 0);
  grid.set_last(6);
  EXPECT_EQ(grid.last_time(), sim(1500ms));
  EXPECT_EQ(grid.next_time(), sim(1750ms));
  EXPECT_EQ(grid.hz(), 4u);
}

}  // namespace peerd::replication::tick_grid_test
