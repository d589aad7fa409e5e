#include "peerd/lab/measure/amiss.hpp"

#include <gtest/gtest.h>

#include "peerd/lab/measure/summary.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::measure::amiss_test {

using Json = nlohmann::ordered_json;

const ScenarioInfo kInfo{"zigzag", "sim", 7, {}};

TEST(Amiss, IsInTheWarningsOfTheSummary) {
  RunRecord run = samples::quiet_run();
  ContactsMeasured& c = run.contacts_measured.emplace();
  c.energy_samples = c.bodies = c.owners = 1;
  EXPECT_FALSE(summarise(kInfo, {&run, 1}).contains("warnings"));
  c.unexplained = {.depth_m = 0.05, .a = "CAR", .b = "CUBE", .at_s = 2.0, .explained_m = 0.04};
  c.at_rest = 101;
  c.sum = c.kinetic = {.start_j = 1.0, .greatest_j = 2.0, .end_j = 1.0};
  run.counters["contacts_capped"] = 3;
  run.counters["jammed"] = 4;
  run.counters["convergence_blocked"] = 5;
  run.counters["contacts_held"] = 20;
  run.counters["contacts_refuted"] = 3;
  const std::vector<RunRecord> runs{samples::quiet_run(), run, run};
  const Json warnings = summarise(kInfo, runs)["warnings"];
  ASSERT_EQ(warnings.size(), 7u) << warnings.dump(2);
  EXPECT_EQ(
      warnings[1],
      "run 2: CAR and CUBE were 50.0 mm in each other at 2.00 s, 10.0 mm more than latency explains; the like in 1 "
      "more run");
  c.is_driven = true;
  run.counters["contacts_refuted"] = 2;
  EXPECT_EQ(summarise(kInfo, {&run, 1})["warnings"].size(), 4u) << "what is driven may be pressed, and brings energy";
}

}  // namespace peerd::measure::amiss_test
