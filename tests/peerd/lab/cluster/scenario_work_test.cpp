#include "peerd/lab/cluster/scenario_work.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::cluster::scenario_work_test {

using testing::ElementsAre;

class ScenarioWork : public testing::Test {
 protected:
  ScenarioWork() {
    options.program = folder.write("program", "1");
    options.version = "peerd 1";
    folder.write("w.wrl", kWorld);
    folder.write("track.csv", "t,x,y,z\n0,0,0,0\n1,1,0,0\n");
    folder.write("s.toml", kScenario);
  }
  Work work() {
    const auto scenario =
        must(config::read_scenario({.file = folder / "s.toml", .configs = {}, .sets = sets, .seed = seed}));
    const auto shared = must(share_world(scenario.world, scenario.reading, scenario.runs));
    return must(scenario_work(options, {folder / "s.toml"}, others, scenario, *shared));
  }
  static constexpr std::string_view kWorld =
      "#VRML V2.0 utf8\nDEF A Transform { children Shape { geometry Box {} } }\n";
  static constexpr std::string_view kScenario =
      "world = \"w.wrl\"\nduration_s = 0.1\n[peer.a]\nid = 1\nowns = [\"A\"]\n[motion.A]\ntrack = \"track.csv\"\n";
  testing_support::ScratchFolder folder;
  ClusterOptions options;
  std::vector<std::string> sets, others;
  std::optional<std::uint64_t> seed;
};

TEST_F(ScenarioWork, IsTheSameTwice) {
  sets = {"network.latency_ms=[0, 10]"};
  const Work first = work(), second = work();
  EXPECT_EQ(first.settings, second.settings);
  EXPECT_EQ(first.program, second.program);
  EXPECT_EQ(first.version, "peerd 1");
  EXPECT_THAT(first.items, ElementsAre("run-001", "run-002"));
}

TEST_F(ScenarioWork, IsAnotherWithAnythingThatRunsAreMadeOf) {
  std::set<std::string> settings{work().settings};
  const auto expect_another = [&](const char* what) { EXPECT_TRUE(settings.insert(work().settings).second) << what; };
  seed = 2;
  expect_another("seed");
  sets = {"network.latency_ms=7"};
  expect_another("--set");
  others = {"8"};
  expect_another("another option");
  folder.write("w.wrl", std::string(kWorld) + "# changed\n");
  expect_another("world");
  folder.write("s.toml", std::string(kScenario) + "# changed\n");
  expect_another("scenario");
  folder.write("track.csv", "t,x,y,z\n0,0,0,0\n1,2,0,0\n");
  expect_another("recorded motion");
  folder.write("wall.wrl", "DEF WALL Transform {}\n");
  sets = {"event.e={at_s = 0.1, kind = \"add\", peer = \"a\", file = \"wall.wrl\"}"};
  expect_another("event");
  folder.write("wall.wrl", "DEF WALL Transform { translation 1 0 0 }\n");
  expect_another("nodes that an event adds");
}

TEST_F(ScenarioWork, HasTheHashOfTheProgramsFile) {
  const std::string before = work().program;
  folder.write("program", "2");
  EXPECT_NE(work().program, before);
  options.program = folder / "none";
  EXPECT_FALSE(work_of_this_program(options, "sim"));
}

}  // namespace peerd::cluster::scenario_work_test
