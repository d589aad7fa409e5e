#include "replication/edits/scene/known_steps.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace peerd::replication::known_steps_test {

TEST(KnownSteps, KnowNothingAtFirst) {
  const KnownSteps steps;
  EXPECT_EQ(steps.last_number(), 0u);
  EXPECT_EQ(steps.last_known(), 0u);
  EXPECT_EQ(steps.known_at(5), 0u);
}

// Steps of all sizes, against a map of them.
TEST(KnownSteps, AreThoseThatWereAdded) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    std::map<std::uint32_t, std::uint32_t> expected;
    KnownSteps steps;
    std::uint32_t number = 0, known = 0;
    for (int i = 0; i < 500; ++i) {
      number += 1 + static_cast<std::uint32_t>(random() % (random() % 10 == 0 ? 40'000 : 3));
      known += 1 + static_cast<std::uint32_t>(random() % (random() % 10 == 0 ? 4'000'000 : 200));
      steps.add(number, known);
      expected[number] = known;
      ASSERT_EQ(steps.last_number(), number);
      ASSERT_EQ(steps.last_known(), known);
    }
    for (const auto& [from, up_to] : expected) {
      EXPECT_EQ(steps.known_at(from), up_to);
      const auto at = expected.find(from);
      if (!expected.contains(from - 1)) {
        EXPECT_EQ(steps.known_at(from - 1), at == expected.begin() ? 0 : std::prev(at)->second);
      }
    }
    EXPECT_EQ(steps.known_at(~0u), known);
  }
}

}  // namespace peerd::replication::known_steps_test
