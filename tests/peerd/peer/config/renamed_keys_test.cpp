#include "peerd/peer/config/renamed_keys.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/must.hpp"
#include "tests/peerd/peer/config/scenario_text.hpp"

namespace peerd::config::renamed_keys_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Renamed {
  toml::table root;
  std::vector<std::string> warnings;
  std::string error;
};
Renamed renamed(const std::string& text) {
  Renamed out;
  out.root = *parse_toml(text, "my.toml");
  if (const auto done = rename_old_keys(out.root, out.warnings); !done) out.error = done.error().text;
  return out;
}

TEST(RenamedKeys, NewNamesStayAsTheyAre) {
  const std::string text =
      "enslaves = 1\n[peer.a]\nid = 1\nowns = [\"X\"]\n[peer.a.motion.enslaves]\nx = \"t\"\n"
      "[replication]\npiggyback_fraction = 0.5\n[network]\nalong_at = 2\n";
  const Renamed same = renamed(text);
  EXPECT_EQ(same.root, *parse_toml(text, "my.toml")) << "old names are names at their own place alone";
  EXPECT_THAT(same.warnings, IsEmpty());
  EXPECT_EQ(same.error, "");
}

TEST(RenamedKeys, OldNamesBecomeNewOnesAndAreTold) {
  const Renamed r = renamed("[peer.a]\nid = 1\n  enslaves = [\"X\",\n\"Y\"]\n[replication]\nalong_at = 0.25\n");
  EXPECT_EQ(r.error, "");
  EXPECT_EQ(r.root, toml::parse("[peer.a]\nid = 1\nowns = [\"X\", \"Y\"]\n[replication]\npiggyback_fraction = 0.25\n"));
  EXPECT_THAT(r.warnings, ElementsAre("my.toml:3:3: warning: peer.a.enslaves is now called peer.a.owns",
                                      "my.toml:6:1: warning: replication.along_at is now called "
                                      "replication.piggyback_fraction"));
  const auto* const list = r.root.at_path("peer.a.owns").as_array();
  ASSERT_NE(list, nullptr);
  EXPECT_EQ(list->source().begin, (toml::source_position{3, 14})) << "errors about its value find their place";
  EXPECT_EQ(list->get(1)->source().begin, (toml::source_position{4, 1}));
}

TEST(RenamedKeys, BothNamesAreAnError) {
  const Renamed r = renamed("[replication]\npiggyback_fraction = 1\nalong_at = 0.25\n");
  EXPECT_EQ(r.error,
            "my.toml:3:1: error: replication.along_at and replication.piggyback_fraction are two names of one key; "
            "leave out replication.along_at");
  EXPECT_THAT(renamed("[peer.a]\nenslaves = []\nowns = []\n").error, HasSubstr("peer.a.enslaves and peer.a.owns"));
}

TEST(RenamedKeys, DottedNamesOfSweepsAndExpectationsAreKeysToo) {
  const Renamed r = renamed(
      "[sweep]\n\"replication.along_at\" = [0.5, 1]\n\"peer.a.enslaves.0\" = [\"X\"]\n"
      "[expect.near]\nwhere = { \"replication.along_at\" = 1 }\n");
  EXPECT_EQ(r.root, toml::parse("[sweep]\n\"replication.piggyback_fraction\" = [0.5, 1]\n\"peer.a.owns.0\" = [\"X\"]\n"
                                "[expect.near]\nwhere = { \"replication.piggyback_fraction\" = 1 }\n"));
  EXPECT_EQ(r.warnings.size(), 3u);
  EXPECT_THAT(renamed("[sweep]\n\"replication.along_at\" = [1]\n\"replication.piggyback_fraction\" = [1]\n").error,
              HasSubstr("my.toml:2:1: error: replication.along_at and replication.piggyback_fraction"));
}

TEST(RenamedKeys, AssignmentsAreRenamedByTheirKeysAndInsideOfTheirValues) {
  const auto assigned = [](const std::string& text, std::vector<std::string>& warnings) {
    Assignment set = *parse_assignment(text);
    EXPECT_TRUE(rename_old_keys(set, warnings)) << text;
    std::ostringstream out;
    out << set.key << " | " << set.holder;
    return out.str();
  };
  std::vector<std::string> warnings;
  EXPECT_EQ(assigned("replication.order=2", warnings), "replication.order | value = 2");
  EXPECT_THAT(warnings, IsEmpty());
  EXPECT_EQ(assigned("peer.a.enslaves=[\"X\"]", warnings), "peer.a.owns | value = [ 'X' ]");
  EXPECT_EQ(assigned("peer.a.enslaves.1=X", warnings), "peer.a.owns.1 | value = 'X'");
  EXPECT_EQ(assigned("replication={along_at = 1}", warnings), "replication | value = { piggyback_fraction = 1 }");
  EXPECT_THAT(warnings, ElementsAre("warning: --set peer.a.enslaves is now called peer.a.owns",
                                    "warning: --set peer.a.enslaves.1 is now called peer.a.owns.1",
                                    HasSubstr("warning: replication.along_at is now called")));
  Assignment both = *parse_assignment("peer.a={enslaves = [], owns = []}");
  EXPECT_THAT(error_of(rename_old_keys(both, warnings)).text,
              HasSubstr("peer.a.enslaves and peer.a.owns are two names"));
}

// Whatever part of a configuration brings the old name, the run is the one that the new name gives.
class RenamedKeysOfAScenario : public testing_support::ScenarioText {
 protected:
  RenamedKeysOfAScenario() : ScenarioText("world = \"w.wrl\"\n[peer.a]\nid = 1\n") {}
  Result<Scenario> read(const std::string& replication, const std::string& peer, const std::string& overlay = "",
                        std::vector<std::string> sets = {}) {
    request.configs = {folder.write("over.toml", overlay)};
    return result(peer + "\n[replication]\n" + replication + "\n", std::move(sets));
  }
};

TEST_F(RenamedKeysOfAScenario, FileOverlayAndSetTakeBothNames) {
  const auto now = must(read("piggyback_fraction = 0.5", "owns = [\"CAR\"]"));
  EXPECT_THAT(now.warnings, IsEmpty());
  const std::string in_file = (folder / "my.toml").string(), in_overlay = (folder / "over.toml").string();
  const auto of_file = read("along_at = 0.5", "enslaves = [\"CAR\"]");
  const auto of_overlay = read("", "", "[replication]\nalong_at = 0.5\n[peer.a]\nenslaves = [\"CAR\"]\n");
  const auto of_sets = read("", "", "", {"replication.along_at=0.5", "peer.a.enslaves=[\"CAR\"]"});
  for (const auto* const old : {&of_file, &of_overlay, &of_sets}) {
    ASSERT_TRUE(*old) << old->error().text;
    EXPECT_EQ((*old)->runs.size(), 1u) << "the list of --set is one value";
    EXPECT_EQ((*old)->runs.front().toml, now.runs.front().toml);
    EXPECT_EQ((*old)->runs.front().replication.policy.piggyback_fraction, 0.5);
    ASSERT_EQ((*old)->runs.front().peers.front().owns.size(), 1u);
    EXPECT_EQ((*old)->warnings.size(), 2u);
  }
  EXPECT_THAT(of_file->warnings, testing::Each(testing::StartsWith(in_file + ":")));
  EXPECT_THAT(of_overlay->warnings, testing::Each(testing::StartsWith(in_overlay + ":")));
  EXPECT_EQ(of_sets->runs.front().params.dump(), R"({"peer.a.owns":["CAR"],"replication.piggyback_fraction":0.5})");
}

TEST_F(RenamedKeysOfAScenario, TheLaterOneWinsWhateverItsName) {
  const auto fraction = [&](const auto& scenario) {
    EXPECT_TRUE(scenario) << scenario.error().text;
    return scenario->runs.front().replication.policy.piggyback_fraction;
  };
  EXPECT_EQ(fraction(read("along_at = 0.5", "", "[replication]\npiggyback_fraction = 0.75\n")), 0.75);
  EXPECT_EQ(fraction(read("piggyback_fraction = 0.5", "", "[replication]\nalong_at = 0.75\n")), 0.75);
  EXPECT_EQ(fraction(read("along_at = 0.5", "", "", {"replication.piggyback_fraction=0.25"})), 0.25);
  EXPECT_EQ(fraction(read("piggyback_fraction = 0.5", "", "", {"replication.along_at=0.25"})), 0.25);
}

TEST_F(RenamedKeysOfAScenario, BothNamesInOneFileAreRefused) {
  EXPECT_THAT(error_of(read("along_at = 0.5\npiggyback_fraction = 0.5", "")),
              IsError(2, HasSubstr("my.toml:6:1: error: replication.along_at and ")));
}

TEST_F(RenamedKeysOfAScenario, AnOldNameInASweepSweeps) {
  const auto swept = must(read("order = 1\n[sweep]\n\"replication.along_at\" = [0.25, 0.5]", ""));
  ASSERT_EQ(swept.runs.size(), 2u);
  EXPECT_EQ(swept.runs.back().replication.policy.piggyback_fraction, 0.5);
  EXPECT_EQ(swept.warnings.size(), 1u) << "once, and not once a run";
}

TEST_F(RenamedKeysOfAScenario, ATableOfTheWorldIsItsKeys) {
  const std::string peer = "[peer.a]\nid = 1\n";
  const auto table = folder.write("t.toml", "[world]\nfile = \"w.wrl\"\nlenient = true\n" + peer);
  const auto keys = folder.write("k.toml", "world = \"w.wrl\"\n" + peer);
  request.file = table;
  const auto by_table = must(read_scenario(request));
  EXPECT_TRUE(by_table.reading.lenient);
  EXPECT_EQ(by_table.world, folder / "w.wrl");
  request.file = keys;
  EXPECT_FALSE(must(read_scenario(request)).reading.lenient);
  request.sets = {"world.lenient=true"};
  EXPECT_TRUE(must(read_scenario(request)).reading.lenient);
  request.sets = {"lenient=true"};
  EXPECT_TRUE(must(read_scenario(request)).reading.lenient);
}

}  // namespace peerd::config::renamed_keys_test
