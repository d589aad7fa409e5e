// Two peers of nobody's session that tell each other of an object, over sockets of their own.
#include "peerd/rehearsal.hpp"

#include <gtest/gtest.h>

#include <ostream>
#include <string>

namespace peerd {
namespace {

using replication::PublishPolicy;

struct Policy {
  const char* name;
  PublishPolicy policy;
};
void PrintTo(const Policy& p, std::ostream* out) { *out << p.name; }

class RehearsalOf : public testing::TestWithParam<Policy> {};

// So many runs tell as many updates, which leave, come back and are taken; but for some that a kernel with much to do
// may still hold back.
void expect_told(Rehearsal& rehearsal) {
  constexpr std::uint64_t kRuns = 200;
  const std::uint64_t before = rehearsal.heard();
  for (std::uint64_t i = 0; i < kRuns; ++i) rehearsal.run();
  EXPECT_GE(rehearsal.heard(), before + kRuns * 9 / 10);
}

// However updates are published.
TEST_P(RehearsalOf, TellsInEachRun) {
  const auto rehearsal = Rehearsal::make(GetParam().policy);
  ASSERT_TRUE(rehearsal) << rehearsal.error().sentence;
  expect_told(**rehearsal);
}

PublishPolicy with(auto change) {
  PublishPolicy policy;
  change(policy);
  return policy;
}

INSTANTIATE_TEST_SUITE_P(
    Policies, RehearsalOf,
    testing::Values(Policy{"Seed", {}}, Policy{"ChosenModels", with([](PublishPolicy& p) { p.models.emplace(); })},
                    Policy{"UpdatesByGain", with([](PublishPolicy& p) { p.wanted_error_m = 0.1; })},
                    Policy{"Snapshots", with([](PublishPolicy& p) { p.snapshots_hz = 20; })},
                    Policy{"HardlyAnyBytes", with([](PublishPolicy& p) { p.bytes_per_s = 1.0; })},
                    Policy{"ALooseThreshold", with([](PublishPolicy& p) { p.error_threshold_m = 100.0; })}),
    [](const auto& instance) { return std::string(instance.param.name); });

TEST(Rehearsal, TellsInEachRunOfASecondSession) {
  const auto rehearsal = Rehearsal::make({});
  ASSERT_TRUE(rehearsal) << rehearsal.error().sentence;
  for (std::uint64_t i = 0; i < Rehearsal::kRunsOfASession; ++i) (*rehearsal)->run();
  EXPECT_GE((*rehearsal)->heard(), Rehearsal::kRunsOfASession * 9 / 10);
  expect_told(**rehearsal);
}

}  // namespace
}  // namespace peerd
