#include "peerd/lab/measure/summary.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "peerd/lab/report/table.hpp"
#include "tests/has_members.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::measure::summary_test {

using Json = nlohmann::ordered_json;
using samples::ghost_sample, samples::kA, samples::kB, samples::kC, samples::kCar, samples::kCube;

const ScenarioInfo kInfo{"zigzag", "sim", 7, {}};

std::vector<std::string> keys_of(const Json& object) {
  std::vector<std::string> keys;
  for (const auto& item : object.items()) keys.push_back(item.key());
  return keys;
}

TEST(Summary, HasTheShapeOfTheDesign) {
  const Json s = summarise(kInfo, samples::zigzag_sweep());
  EXPECT_THAT(keys_of(s), testing::ElementsAre("scenario", "mode", "seed", "runs"));
  ASSERT_EQ(s["runs"].size(), 6u);
  const Json& run = s["runs"][0];
  EXPECT_THAT(keys_of(run), testing::ElementsAre("params", "seed", "objects", "collisions", "contacts", "traffic",
                                                 "groups_joined", "state_roots_equal", "counters"));
  EXPECT_THAT(keys_of(run["objects"][0]),
              testing::ElementsAre("path", "owner", "observer", "updates_sent", "bytes_sent", "samples",
                                   "ghost_error_m", "shown_error_m", "view_difference_m", "inconsistency_m_s", "rest"));
  EXPECT_THAT(keys_of(run["objects"][0]["ghost_error_m"]), testing::ElementsAre("mean", "rms", "p99", "max"));
  EXPECT_THAT(keys_of(run["collisions"]), testing::ElementsAre("decided", "agreed", "disagreed", "spurious", "missed",
                                                               "revised", "shared", "decision_latency_ms"));
  EXPECT_THAT(keys_of(run["collisions"]["decision_latency_ms"]), testing::ElementsAre("mean", "p99", "max"));
  EXPECT_THAT(keys_of(run["traffic"]), testing::ElementsAre("packets", "bytes", "bytes_per_s"));
  EXPECT_EQ(run["params"]["network.latency_ms"], 5);
}

TEST(Summary, HandNumbers) {
  RunRecord run = samples::quiet_run();
  run.ghost_samples = {ghost_sample(0, kB, kCar, {0, 0, 0}, {0, 0, 0}), ghost_sample(1, kB, kCar, {0, 0, 0}, {3, 0, 4}),
                       ghost_sample(3, kB, kCar, {1, 0, 0}, {2, 0, 0})};
  run.updates = {{0, kA, kCar, 30, 0.5, "first"}, {1, kA, kCar, 32, 0.5, "error"}, {1, kB, kCube, 30, 0.5, "time"}};
  run.datagrams = {{0, kA, 100}, {1, kA, 50}, {2, kC, 25}};
  run.groups_joined = 12;
  run.worlds_equal = false;
  const Json s = summarise(kInfo, {&run, 1})["runs"][0];

  ASSERT_EQ(s["objects"].size(), 4u);  // CAR at b and c, CUBE at a and c
  const Json& row = s["objects"][0];
  EXPECT_THAT(row, HasMembers(R"(
    {"path": "CAR", "owner": "a", "observer": "b", "updates_sent": 2, "bytes_sent": 62, "samples": 3})"));
  EXPECT_DOUBLE_EQ(row["ghost_error_m"]["mean"], 2.0);
  EXPECT_DOUBLE_EQ(row["ghost_error_m"]["max"], 5.0);
  EXPECT_DOUBLE_EQ(row["shown_error_m"]["max"], 2.5);
  EXPECT_DOUBLE_EQ(row["view_difference_m"]["max"], 2.5);
  EXPECT_DOUBLE_EQ(row["inconsistency_m_s"], 2.5 + 6.0);
  EXPECT_EQ(s["objects"][1]["observer"], "c");
  EXPECT_EQ(s["objects"][1]["samples"], 0);
  EXPECT_EQ(s["objects"][2]["observer"], "a");
  EXPECT_EQ(s["traffic"], Json::parse(R"({"packets": 3, "bytes": 175, "bytes_per_s": 17.5})"));
  EXPECT_EQ(s["groups_joined"], 12);
  EXPECT_EQ(s["state_roots_equal"], false);
}

TEST(Summary, AreasOfInterestAreThereWhereSomebodyAsked) {
  RunRecord run = samples::quiet_run();
  EXPECT_FALSE(summarise(kInfo, {&run, 1})["runs"][0].contains("interest"));
  InterestRecord& interest = run.interest.emplace();
  interest.latency_ms = 100;
  interest.longest_missing_ms = 50;
  interest.samples = 1000;
  interest.missing_samples = 3;
  interest.gaps = 1;
  interest.peers = {{kA, 2.5, 300, 200, 4, 3, 2, 9.5}, {kB, 0.0, 100, 0, 0, 0, 0, 1.0}};
  const Json s = summarise(kInfo, {&run, 1})["runs"][0]["interest"];
  EXPECT_EQ(s["longest_missing_ms"], 50.0);
  EXPECT_EQ(s["missing_samples"], 3);
  EXPECT_DOUBLE_EQ(s["received_over_interest"], 2.0) << "of all together";
  EXPECT_DOUBLE_EQ(s["peers"][0]["received_over_interest"], 1.5);
  EXPECT_DOUBLE_EQ(s["peers"][1]["received_over_interest"], 0.0) << "no number, and JSON has no NaN";
  EXPECT_EQ(s["peers"][0]["peer"], "a");
  EXPECT_EQ(s["peers"][0]["joins_in_a_second"], 2);
}

// One outcome that two peers state counts once; what a ghost meets does not.
TEST(Summary, CountsContactsByTheSecond) {
  RunRecord run = samples::quiet_run(4.0);
  const auto add = [&](double t_s, PeerId peer, const char* kind) {
    run.contacts.push_back({t_s, peer, kind, kCar, samples::kWall, Vec3::UnitX(), t_s});
  };
  for (const double t_s : {0.5, 1.0, 1.5, 1.75, 3.25}) add(t_s, kA, "scene");
  add(3.25, kB, "scene");
  add(3.5, kB, "predicted");
  const Json contacts = summarise(kInfo, {&run, 1})["runs"][0]["contacts"];
  EXPECT_EQ(contacts["count"], 5);
  EXPECT_EQ(contacts["per_s"]["max"], 3);
  EXPECT_DOUBLE_EQ(contacts["per_s"]["mean"], 1.25);
  EXPECT_EQ(contacts["last_s"], 1);
  EXPECT_FALSE(contacts.contains("overlap")) << "nothing was sampled";
}

TEST(Summary, TheNetworkIsThereWhereItWasMeasured) {
  RunRecord run = samples::quiet_run();
  EXPECT_FALSE(summarise(kInfo, {&run, 1})["runs"][0].contains("network"));
  run.network = {.links = {{.from = kA,
                            .to = kB,
                            .probes_sent = 4,
                            .probes_lost = 1,
                            .probes_duplicated = 0,
                            .delay_ms = {103, 101, 102},
                            .packets = 190,
                            .packets_lost = 10}},
                 .oversleep_before_ms = {0.25, 0.75},
                 .oversleep_during_ms = {1, 2, 9}};
  const Json s = summarise(kInfo, {&run, 1})["runs"][0]["network"];
  const Json& link = s["links"][0];
  EXPECT_EQ(link["from"], "a");
  EXPECT_EQ(link["to"], "b");
  EXPECT_EQ(link["probes"], (Json{{"sent", 4}, {"lost", 1}, {"duplicated", 0}}));
  EXPECT_EQ(link["delay_ms"], (Json{{"min", 101.0}, {"mean", 102.0}, {"p99", 103.0}, {"max", 103.0}}));
  EXPECT_DOUBLE_EQ(link["loss"], 0.05);
  EXPECT_DOUBLE_EQ(s["oversleep_ms"]["before"]["mean"], 0.5);
  EXPECT_DOUBLE_EQ(s["oversleep_ms"]["during"]["max"], 9.0);
}

TEST(Summary, NothingInItIsNull) {
  RunRecord run = samples::quiet_run();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  run.ghost_samples = {ghost_sample(0, kB, kCar, {nan, 0, 0}, {0, 0, 0}),
                       ghost_sample(1, kB, kCar, {0, 0, 0}, {1, 0, 0}),
                       ghost_sample(2, kB, kCar, {0, 0, 0}, {1e200, 0, 0})};
  const std::vector<RunRecord> runs{run, RunRecord{}};
  const Json s = summarise(kInfo, runs);
  EXPECT_EQ(s.dump().find("null"), std::string::npos) << s.dump(2);
  EXPECT_EQ(s["runs"][0]["counters"]["report.samples_not_finite"], 2);
  EXPECT_DOUBLE_EQ(s["runs"][0]["objects"][0]["ghost_error_m"]["mean"], 1.0);
}

TEST(Summary, HasTheNetworksSettingsThatAreNotDefaults) {
  RunRecord run = samples::zigzag_run(0.1);
  EXPECT_FALSE(summarise(kInfo, {&run, 1})["runs"][0].contains("network_settings"));
  run.network_settings = {{"network.jitter_ms", 20.0}};
  EXPECT_EQ(summarise(kInfo, {&run, 1})["runs"][0]["network_settings"].dump(), R"({"network.jitter_ms":20.0})");
}

TEST(Summary, WarningsAreKept) {
  ScenarioInfo info = kInfo;
  info.warnings = {"the link was slow"};
  const Json s = summarise(info, {});
  EXPECT_EQ(s["warnings"][0], "the link was slow");
  EXPECT_THAT(report::table(s), testing::HasSubstr("warning: the link was slow\n"));
}

}  // namespace peerd::measure::summary_test
