#include "peerd/net/seal/replay_window.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace peerd::seal {
namespace {

TEST(ReplayWindows, TakeEachCounterOnce) {
  ReplayWindow window;
  EXPECT_FALSE(window.take(0)) << "counters count from 1";
  for (const std::uint64_t counter : {5u, 1u, 4u, 2000u, 1999u, 1000u}) {
    EXPECT_TRUE(window.take(counter)) << counter;
    EXPECT_FALSE(window.take(counter)) << counter;
  }
  EXPECT_EQ(window.newest(), 2000u);
  EXPECT_FALSE(window.take(2000 - ReplayWindow::kWidth)) << "too old";
  EXPECT_TRUE(window.take(2001 - ReplayWindow::kWidth)) << "just not";
}

// Against a set of all that has come.
TEST(ReplayWindows, AreRightForAnyOrder) {
  std::mt19937_64 random(7);
  for (const std::uint64_t step : {3u, 70u, 1100u, 5000u}) {
    ReplayWindow window;
    std::set<std::uint64_t> taken;
    std::uint64_t newest = 0;
    for (int i = 0; i < 20000; ++i) {
      const std::uint64_t back = random() % 1200, ahead = random() % step;
      const std::uint64_t counter = newest + ahead > back ? newest + ahead - back : 1;
      const bool fits = counter + ReplayWindow::kWidth > newest && !taken.contains(counter);
      ASSERT_EQ(window.take(counter), fits) << counter << " after " << newest;
      if (fits) taken.insert(counter);
      newest = std::max(newest, fits ? counter : 0);
    }
  }
}

}  // namespace
}  // namespace peerd::seal
