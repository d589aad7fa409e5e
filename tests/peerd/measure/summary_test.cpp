#include "peerd/measure/summary.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <sstream>

#include "peerd/measure/sweep.hpp"
#include "peerd/report/table.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::report::summary_test {

using Json = nlohmann::ordered_json;
using samples::belief, samples::kA, samples::kB, samples::kC, samples::kCar, samples::kCube;

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
  EXPECT_THAT(keys_of(run), testing::ElementsAre("params", "seed", "objects", "collisions", "traffic", "groups_joined",
                                                 "state_roots_equal", "counters"));
  EXPECT_THAT(keys_of(run["objects"][0]),
              testing::ElementsAre("path", "owner", "observer", "updates_sent", "bytes_sent", "samples",
                                   "ghost_error_m", "shown_error_m", "view_difference_m", "inconsistency_m_s"));
  EXPECT_THAT(keys_of(run["objects"][0]["ghost_error_m"]), testing::ElementsAre("mean", "rms", "p99", "max"));
  EXPECT_THAT(keys_of(run["collisions"]), testing::ElementsAre("decided", "agreed", "disagreed", "spurious", "missed",
                                                               "revised", "shared", "decision_latency_ms"));
  EXPECT_THAT(keys_of(run["collisions"]["decision_latency_ms"]), testing::ElementsAre("mean", "p99", "max"));
  EXPECT_THAT(keys_of(run["traffic"]), testing::ElementsAre("packets", "bytes", "bytes_per_s"));
  EXPECT_EQ(run["params"]["network.latency_ms"], 5);
}

TEST(Summary, HandNumbers) {
  RunRecord run = samples::quiet_run();
  run.ghost_samples = {belief(0, kB, kCar, {0, 0, 0}, {0, 0, 0}), belief(1, kB, kCar, {0, 0, 0}, {3, 0, 4}),
                 belief(3, kB, kCar, {1, 0, 0}, {2, 0, 0})};
  run.updates = {{0, kA, kCar, 30, 0.5, "first"}, {1, kA, kCar, 32, 0.5, "error"}, {1, kB, kCube, 30, 0.5, "time"}};
  run.datagrams = {{0, kA, 100}, {1, kA, 50}, {2, kC, 25}};
  run.groups_joined = 12;
  run.worlds_equal = false;
  const Json s = summarise(kInfo, {&run, 1})["runs"][0];

  ASSERT_EQ(s["objects"].size(), 4u);  // CAR at b and c, CUBE at a and c
  const Json& row = s["objects"][0];
  EXPECT_EQ(row["path"], "CAR");
  EXPECT_EQ(row["owner"], "a");
  EXPECT_EQ(row["observer"], "b");
  EXPECT_EQ(row["updates_sent"], 2);
  EXPECT_EQ(row["bytes_sent"], 62);
  EXPECT_EQ(row["samples"], 3);
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

TEST(Summary, ARunCountsWhereTheComputerKeptTime) {
  struct Case {
    double before_ms, during_ms;
    bool steady;
  };
  RunRecord run = samples::quiet_run();
  for (const Case& c : {Case{10, 50, true}, Case{10.1, 50, false}, Case{10, 50.1, false}}) {
    run.network = {.links = {}, .oversleep_before_ms = {0, c.before_ms}, .oversleep_during_ms = {0, c.during_ms}};
    EXPECT_EQ(summarise(kInfo, {&run, 1})["runs"][0]["network"]["steady"], c.steady);
  }
}

TEST(Summary, NothingInItIsNull) {
  RunRecord run = samples::quiet_run();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  run.ghost_samples = {belief(0, kB, kCar, {nan, 0, 0}, {0, 0, 0}), belief(1, kB, kCar, {0, 0, 0}, {1, 0, 0}),
                 belief(2, kB, kCar, {0, 0, 0}, {1e200, 0, 0})};
  const std::vector<RunRecord> runs{run, RunRecord{}};
  const Json s = summarise(kInfo, runs);
  EXPECT_EQ(s.dump().find("null"), std::string::npos) << s.dump(2);
  EXPECT_EQ(s["runs"][0]["counters"]["report.samples_not_finite"], 2);
  EXPECT_DOUBLE_EQ(s["runs"][0]["objects"][0]["ghost_error_m"]["mean"], 1.0);
}

TEST(Summary, SameRecordsSameBytes) {
  EXPECT_EQ(summarise(kInfo, samples::zigzag_sweep()).dump(2), summarise(kInfo, samples::zigzag_sweep()).dump(2));
}

TEST(Summary, WarningsAreKept) {
  ScenarioInfo info = kInfo;
  info.warnings = {"the link was slow"};
  const Json s = summarise(info, {});
  EXPECT_EQ(s["warnings"][0], "the link was slow");
  EXPECT_THAT(table(s), testing::HasSubstr("warning: the link was slow\n"));
}

TEST(Table, ARowARunWithin100Columns) {
  const std::string text = table(summarise(kInfo, samples::zigzag_sweep()));
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 3u + 6u) << text;
  for (const std::string& line : lines) EXPECT_LE(line.size(), 100u);
  EXPECT_THAT(lines[0], testing::HasSubstr("CAR"));
  EXPECT_THAT(lines[1], testing::AllOf(testing::HasSubstr("at b"), testing::HasSubstr("at c")));
  EXPECT_THAT(lines[2], testing::AllOf(testing::HasSubstr("approach"), testing::HasSubstr("latency_ms")));
  EXPECT_THAT(lines[3], testing::HasSubstr("dr"));
  for (std::size_t i = 3; i < lines.size(); ++i) EXPECT_EQ(lines[i].size(), lines[2].size()) << text;  // aligned
}

TEST(Table, ManyObserversHaveARowEach) {
  RunRecord run = samples::zigzag_run(0.1);
  const PeerId d{4};
  run.peers.push_back({d, "d"});
  for (int i = 0; i < 3; ++i) run.ghost_samples.push_back(belief(i, d, kCar, {0, 0, 0}, {1, 0, 0}));
  const std::string text = table(summarise(kInfo, {&run, 1}));
  EXPECT_EQ(std::ranges::count(text, '\n'), 2 + 3) << text;
  EXPECT_THAT(text, testing::HasSubstr("observer"));
}

TEST(Table, AnUnseenObjectIsADashNotAZero) {
  RunRecord run = samples::quiet_run();
  EXPECT_THAT(table(summarise(kInfo, {&run, 1})), testing::HasSubstr(" - "));
}

TEST(Sweep, VaryingKeysInOrderWhateverTheirType) {
  const std::vector<Params> runs{{{"a.x", 1}, {"b.x", "u"}, {"c", 5}, {"e", 100}},
                                 {{"a.x", 2}, {"b.x", "u"}, {"c", 5}, {"d", true}, {"e", 100.0}}};
  EXPECT_THAT(varying_keys(runs), testing::ElementsAre("a.x", "d"));
  EXPECT_TRUE(varying_keys({}).empty());
}

TEST(Sweep, Words) {
  const Params run{{"network.latency_ms", 100.0},
                   {"replication.approach", "dr+rcp"},
                   {"replication.order", 2},
                   {"motion.speed_m_s", 2.5},
                   {"a.rate_hz", 60},
                   {"b.rate_hz", 30}};
  std::vector<std::string> keys;
  for (const auto& item : run.items()) keys.push_back(item.key());
  EXPECT_EQ(describe(run, keys), "latency 100 ms, dr+rcp, order 2, speed 2.5 m/s, a.rate 60 Hz, b.rate 30 Hz");
  EXPECT_EQ(axis_label("network.latency_ms", keys), "latency [ms]");
  EXPECT_EQ(short_name("a.rate_hz", keys), "a.rate_hz");
}

}  // namespace peerd::report::summary_test
