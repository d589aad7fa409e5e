#include "peerd/lab/live/run_assembler.hpp"

#include <gtest/gtest.h>

#include "peerd/lab/sim/simulated_run.hpp"
#include "tests/sim/run_scenario.hpp"

namespace peerd::run_assembler_test {

const std::string kScenario = PEERD_SOURCE_DIR "/configs/scenarios/comings.toml";

// While the run goes on, ghosts wait for the next tick of their owners and ticks are forgotten; afterwards all rows are
// there at once. Peers come and go in this scenario, and clocks are apart.
TEST(RunAssembler, GivesTheSameWhileRowsComeAsAfterwards) {
  const config::Scenario scenario =
      sim::testing_support::scenario_of(kScenario, {"network.jitter_ms=20", "network.loss=0.05"});
  const auto shared = must(share_world(scenario.world));
  const config::RunSettings& run = scenario.runs.front();
  const measure::RunRecord after = must(assemble(run, *shared, must(sim::simulate(run, *shared))));
  const measure::RunRecord during = must(sim::simulated_run(run, *shared));
  ASSERT_EQ(during.ghost_samples.size(), after.ghost_samples.size());
  ASSERT_GT(during.ghost_samples.size(), 100u);
  const measure::ScenarioInfo info{"s", "sim", 1, {}};
  EXPECT_EQ(measure::summarise(info, {&during, 1}).dump(), measure::summarise(info, {&after, 1}).dump());
  EXPECT_EQ(during.outlines.size(), 6u) << "a car, two walls, three cubes";
  EXPECT_EQ(after.outlines.size(), 6u);
  EXPECT_EQ(during.network_settings.dump(),
            R"({"network.latency_ms":100.0,"network.jitter_ms":20.0,"network.loss":0.05})");
  for (std::size_t i = 0; i < during.peers.size(); ++i) EXPECT_EQ(during.peers[i].there_s, after.peers[i].there_s);
}

}  // namespace peerd::run_assembler_test
