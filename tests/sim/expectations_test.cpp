// The repository's own scenarios meet their own expectations.
#include <gmock/gmock.h>

#include "peerd/lab/measure/expectations.hpp"
#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::expectations_test {

using testing_support::run_scenario;

std::vector<measure::CheckedExpectation> checked(const std::string& name, const std::vector<std::string>& sets = {},
                                                 const std::vector<std::filesystem::path>& configs = {}) {
  const std::string file = PEERD_SOURCE_DIR "/configs/scenarios/" + name + ".toml";
  const auto expectations = testing_support::scenario_of(file, sets, configs).expectations;
  std::vector<measure::RunRecord> records;
  auto rows = nlohmann::ordered_json::array();
  for (auto& ran : run_scenario(file, sets, configs)) {
    records.push_back(std::move(ran.record));
    rows.push_back(std::move(ran.summary));
  }
  return measure::check_expectations(expectations, "sim", records, rows);
}

class Expectations : public testing::TestWithParam<const char*> {};
TEST_P(Expectations, Hold) {
  const auto all = checked(GetParam());
  EXPECT_GE(all.size(), 2u);
  for (const auto& e : all) {
    EXPECT_TRUE(e.checked()) << e.expected.name;
    EXPECT_FALSE(e.failed()) << e.expected.name << ": " << e.failures.front().found << ' ' << e.failures.front().why;
  }
}
INSTANTIATE_TEST_SUITE_P(OfScenarios, Expectations,
                         testing::Values("eq47", "snooker", "head-on", "comings", "bounded-latency", "town"),
                         [](const auto& name) {
                           std::string text = name.param;
                           std::erase(text, '-');
                           return text;
                         });

// A crate that is squeezed between the bus and another one stood in the ghosts, and went on in the truth of the peer
// that has neither: its van met it 67 m from there, 14 s later. And the ghost of a ball that has come to rest crept on
// at the ball's last speed, where updates have no acceleration.
TEST(Expectations, HoldInTheTownWithoutAccelerations) {
  for (const auto& e : checked("town", {"replication.model=order", "replication.order=1", "network.latency_ms=0.05"})) {
    EXPECT_FALSE(e.failed()) << e.expected.name << ": " << e.failures.front().object << ' ' << e.failures.front().found;
  }
}

// A network that loses half of everything is not what eq47 expects of itself.
TEST(ExpectationsThatDoNotHold, Fail) {
  const auto all = checked("eq47", {"network.loss=0.5"});
  const auto failed = [](const measure::CheckedExpectation& e) { return e.failed(); };
  EXPECT_TRUE(std::ranges::any_of(all, failed));
  EXPECT_FALSE(std::ranges::all_of(all, failed)) << "all have the same world, whatever is lost";
}

}  // namespace peerd::sim::expectations_test
