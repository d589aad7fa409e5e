// The repository's own scenarios hold what they say of themselves.
#include <gmock/gmock.h>

#include "peerd/report/expectations.hpp"
#include "tests/sim/run_scenario.hpp"

namespace peerd::sim {
namespace {

using testing_support::must;
using testing_support::run_scenario;

std::vector<report::CheckedExpectation> checked(const std::string& name, const std::vector<std::string>& sets = {},
                                                const std::vector<std::filesystem::path>& configs = {}) {
  const std::string file = PEERD_SOURCE_DIR "/configs/scenarios/" + name + ".toml";
  const auto expectations =
      must(config::read_scenario({.file = file, .configs = configs, .sets = sets, .seed = {}})).expectations;
  std::vector<report::RunRecord> records;
  auto rows = nlohmann::ordered_json::array();
  for (auto& ran : run_scenario(file, sets, configs)) {
    records.push_back(std::move(ran.record));
    rows.push_back(std::move(ran.summary));
  }
  return report::check_expectations(expectations, "sim", records, rows);
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
INSTANTIATE_TEST_SUITE_P(OfScenarios, Expectations, testing::Values("eq47", "snooker", "head-on", "comings"),
                         [](const auto& name) {
                           std::string text = name.param;
                           std::erase(text, '-');
                           return text;
                         });

// A network that loses half of everything is not what eq47 expects of itself.
TEST(ExpectationsThatDoNotHold, Fail) {
  const auto all = checked("eq47", {"network.loss=0.5"});
  const auto failed = [](const report::CheckedExpectation& e) { return e.failed(); };
  EXPECT_TRUE(std::ranges::any_of(all, failed));
  EXPECT_FALSE(std::ranges::all_of(all, failed)) << "all have the same world, whatever is lost";
}

}  // namespace
}  // namespace peerd::sim
