#include "core/schedule.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace peerd::schedule_test {

// Any sequence of settings, at any size, gives the answers of a linear search.
TEST(Schedule, FindsWhatIsDueInOrder) {
  std::mt19937_64 rng(1);
  for (const std::size_t count : {0u, 1u, 2u, 3u, 8u, 9u, 100u}) {
    Schedule schedule(count);
    std::vector<SimTime> oracle(count, SimTime::max());
    ASSERT_EQ(schedule.size(), count);
    for (int step = 0; step < 400; ++step) {
      for (int changes = 0; count > 0 && changes < 3; ++changes) {
        const std::size_t number = rng() % count;
        oracle[number] = rng() % 4 == 0 ? SimTime::max() : SimTime{Duration{rng() % 50}};
        schedule.set(number, oracle[number]);
      }
      const SimTime until{Duration{rng() % 60} - Duration{5}};
      std::vector<std::size_t> due, expected;
      for (std::size_t i = schedule.next_due(0, until); i < count; i = schedule.next_due(i + 1, until))
        due.push_back(i);
      for (std::size_t i = 0; i < count; ++i) {
        ASSERT_EQ(schedule.at(i), oracle[i]);
        if (oracle[i] <= until) expected.push_back(i);
      }
      ASSERT_EQ(due, expected) << "of " << count << " at step " << step;
    }
  }
}

TEST(Schedule, NothingIsDueAtFirst) {
  const Schedule schedule(5);
  EXPECT_EQ(schedule.next_due(0, SimTime::max() - Duration{1}), 5u);
}

TEST(Schedule, GrowsAndKeepsWhatIsSet) {
  Schedule schedule;
  for (std::size_t count = 1; count <= 40; count += 3) {
    schedule.grow(count);
    ASSERT_EQ(schedule.size(), count);
    schedule.set(count - 1, SimTime{Duration{static_cast<std::int64_t>(count)}});
    std::vector<std::size_t> due;
    const SimTime until{Duration{100}};
    for (std::size_t i = schedule.next_due(0, until); i < count; i = schedule.next_due(i + 1, until)) due.push_back(i);
    std::vector<std::size_t> expected;
    for (std::size_t set = 1; set <= count; set += 3) expected.push_back(set - 1);
    EXPECT_EQ(due, expected);
    EXPECT_EQ(schedule.next_due(0, SimTime{Duration{static_cast<std::int64_t>(count)}}), 0u);
  }
}

}  // namespace peerd::schedule_test
