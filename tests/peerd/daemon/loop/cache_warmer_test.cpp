// Two private peers that send each other updates over a socket of their own.
#include "peerd/daemon/loop/cache_warmer.hpp"

#include <gtest/gtest.h>

#include <ostream>
#include <string>

#include "tests/must.hpp"

namespace peerd::cache_warmer_test {

using replication::PublishPolicy;

struct Policy {
  const char* name;
  PublishPolicy policy;
};
void PrintTo(const Policy& p, std::ostream* out) { *out << p.name; }

class CacheWarmerOf : public testing::TestWithParam<Policy> {};

// Each run sends one update, which leaves, comes back and is taken, except for some that a busy kernel may still hold.
void expect_sends_updates(CacheWarmer& cache_warmer) {
  constexpr std::uint64_t kRuns = 200;
  const std::uint64_t before = cache_warmer.updates_received();
  for (std::uint64_t i = 0; i < kRuns; ++i) cache_warmer.run();
  EXPECT_GE(cache_warmer.updates_received(), before + kRuns * 9 / 10);
}

// Cache warming works with every publish policy.
TEST_P(CacheWarmerOf, UpdatesInEachRun) {
  const auto cache_warmer = must(CacheWarmer::make(GetParam().policy));
  expect_sends_updates(*cache_warmer);
}

PublishPolicy with(auto change) {
  PublishPolicy policy;
  change(policy);
  return policy;
}

INSTANTIATE_TEST_SUITE_P(
    Policies, CacheWarmerOf,
    testing::Values(Policy{"Default", {}}, Policy{"ChosenModels", with([](PublishPolicy& p) { p.models.emplace(); })},
                    Policy{"Snapshots", with([](PublishPolicy& p) { p.snapshots_hz = 20; })},
                    Policy{"HardlyAnyBytes", with([](PublishPolicy& p) { p.bytes_per_s = 1.0; })},
                    Policy{"ALooseThreshold", with([](PublishPolicy& p) { p.error_threshold_m = 1e9; })}),
    [](const auto& instance) { return std::string(instance.param.name); });

TEST(CacheWarmer, UpdatesInEachRunOfAnotherSession) {
  const auto cache_warmer = must(CacheWarmer::make({}, 500));
  for (int i = 0; i < 1000; ++i) cache_warmer->run();
  EXPECT_EQ(cache_warmer->sessions(), 3u);
  expect_sends_updates(*cache_warmer);
}

}  // namespace peerd::cache_warmer_test
