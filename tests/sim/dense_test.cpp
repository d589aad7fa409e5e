// tests/sim/worlds/dense.toml: chains of collisions between objects of two peers, shorter than a round trip.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>

#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::dense_test {

using testing_support::Ran;
using testing_support::run_scenario;

const std::string kDense = PEERD_SOURCE_DIR "/tests/sim/worlds/dense.toml";
const std::vector<std::filesystem::path> kBest{PEERD_SOURCE_DIR "/configs/best.toml"};

class Dense : public testing::TestWithParam<std::tuple<std::string, int>> {};  // policy, seed
TEST_P(Dense, OneOutcomeEverywhere) {
  const auto& [policy, seed] = GetParam();
  const auto runs = run_scenario(kDense, {"seed=" + std::to_string(seed), "decisions.policy=\"" + policy + '"'}, kBest);
  ASSERT_EQ(runs.size(), 6u);
  for (const Ran& ran : runs) {
    SCOPED_TRACE(ran.settings.params.dump());
    testing_support::expect_one_outcome(ran, 5);
  }
}
INSTANTIATE_TEST_SUITE_P(Seeds, Dense,
                         testing::Combine(testing::Values("id", "velocity", "field-of-view", "expected-error",
                                                          "server"),
                                          testing::Values(1, 2)),
                         [](const auto& run) {
                           std::string name = std::get<0>(run.param) + '_' + std::to_string(std::get<1>(run.param));
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace peerd::sim::dense_test
