#include "peerd/chaos/shrink.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace peerd::chaos::shrink_test {

bool has_fault(const ChaosPlan& plan, std::uint32_t number) {
  return std::ranges::any_of(plan.faults, [&](const Fault& fault) { return fault.number == number; });
}
bool has_edit(const ChaosPlan& plan, std::uint32_t number) {
  return std::ranges::any_of(plan.edits, [&](const PlannedEdit& edit) { return edit.number == number; });
}

// A run that fails by two of its edits and one of its faults.
TEST(Shrink, FindsWhatItTakes) {
  constexpr std::uint64_t kSeed = 11;
  const ChaosPlan whole = draw_plan(kSeed);
  const std::uint32_t fault = whole.faults[whole.faults.size() / 2].number;
  const std::uint32_t edit = whole.edits[3].number, other = whole.edits[whole.edits.size() - 4].number;
  std::size_t asked = 0;
  const auto fails = [&](const ChaosLimits& limits) {
    ++asked;
    const ChaosPlan plan = draw_plan(kSeed, limits);
    return plan.limits.seconds == 60.0 && has_fault(plan, fault) && has_edit(plan, edit) && has_edit(plan, other);
  };
  const Shrunk shrunk = shrink(kSeed, {}, fails, 1000);
  EXPECT_EQ(shrunk.runs, asked);
  const ChaosPlan plan = draw_plan(kSeed, shrunk.limits);
  EXPECT_EQ(plan.faults.size(), 1u);
  EXPECT_EQ(plan.edits.size(), 2u);
  EXPECT_TRUE(has_fault(plan, fault) && has_edit(plan, edit) && has_edit(plan, other));
}

TEST(Shrink, AsksNoMoreThanItMay) {
  std::size_t asked = 0;
  const auto fails = [&](const ChaosLimits&) {
    ++asked;
    return true;
  };
  EXPECT_EQ(shrink(1, {}, fails, 7).runs, 7u);
  EXPECT_EQ(asked, 7u);
}

TEST(Shrink, KeepsWhatFailsOnlyAsAWhole) {
  const Shrunk shrunk = shrink(
      5, {}, [](const ChaosLimits&) { return false; }, 1000);
  EXPECT_EQ(options_of(5, shrunk.limits), "--chaos 5");
}

}  // namespace peerd::chaos::shrink_test
