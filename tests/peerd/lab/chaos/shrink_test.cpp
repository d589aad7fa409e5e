#include "peerd/lab/chaos/shrink.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "peerd/lab/chaos/chaos_run.hpp"

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

// In a run that is too short for peers to do what they must, everything fails.
TEST(Shrink, AsksForNoRunThatIsTooShort) {
  ChaosLimits shortest;
  shortest.seconds = ChaosLimits::kSecondsMin;
  for (const ChaosLimits& limits : {ChaosLimits{}, shortest}) {
    bool shortens = false;
    const auto fails = [&](const ChaosLimits& smaller) {
      EXPECT_GE(smaller.seconds, ChaosLimits::kSecondsMin);
      shortens = shortens || smaller.seconds < limits.seconds;
      return true;
    };
    const Shrunk shrunk = shrink(2, limits, fails, 10);
    EXPECT_EQ(shrunk.limits.seconds, ChaosLimits::kSecondsMin);
    EXPECT_EQ(shortens, limits.seconds > ChaosLimits::kSecondsMin);
  }
}

// Real runs, which count as failed where an author has died by the fault that makes it.
TEST(Shrink, FindsTheFaultOfARealRun) {
  const ChaosLimits limits{.seconds = ChaosLimits::kSecondsMin, .peers = 3};
  const auto fails = [](std::uint64_t seed) {
    return [seed](const ChaosLimits& smaller) {
      return run_chaos(draw_plan(seed, smaller)).branches.contains("author died when its operation was held");
    };
  };
  std::uint64_t seed = 1;
  while (!fails(seed)(limits)) ++seed;
  const Shrunk shrunk = shrink(seed, limits, fails(seed), 80);
  const ChaosPlan plan = draw_plan(seed, shrunk.limits);
  ASSERT_EQ(plan.faults.size(), 1u) << options_of(seed, shrunk.limits);
  EXPECT_EQ(plan.faults[0].kind, FaultKind::kAuthorDies);
  EXPECT_LE(plan.edits.size(), 1u) << "the fault makes an edit of its own, which may be to undo one";
  EXPECT_TRUE(fails(seed)(shrunk.limits));
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
