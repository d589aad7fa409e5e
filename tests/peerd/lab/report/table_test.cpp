#include "peerd/lab/report/table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "peerd/lab/measure/summary.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::report::table_test {

using measure::samples::ghost_sample, measure::samples::kCar;

const measure::ScenarioInfo kInfo{"zigzag", "sim", 7, {}};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TEST(Table, ARowARunWithin100Columns) {
  const std::string text = table(measure::summarise(kInfo, measure::samples::zigzag_sweep()));
  const std::vector<std::string> lines = lines_of(text);
  ASSERT_EQ(lines.size(), 3u + 6u) << text;
  for (const std::string& line : lines) EXPECT_LE(line.size(), 100u);
  EXPECT_THAT(lines[0], testing::HasSubstr("CAR"));
  EXPECT_THAT(lines[1], testing::AllOf(testing::HasSubstr("at b"), testing::HasSubstr("at c")));
  EXPECT_THAT(lines[2], testing::AllOf(testing::HasSubstr("approach"), testing::HasSubstr("latency_ms")));
  EXPECT_THAT(lines[3], testing::HasSubstr("dr"));
  for (std::size_t i = 3; i < lines.size(); ++i) EXPECT_EQ(lines[i].size(), lines[2].size()) << text;  // aligned
}

TEST(Table, ManyObserversHaveARowEach) {
  measure::RunRecord run = measure::samples::zigzag_run(0.1);
  const PeerId d{4};
  run.peers.push_back({d, "d"});
  for (int i = 0; i < 3; ++i) run.ghost_samples.push_back(ghost_sample(i, d, kCar, {0, 0, 0}, {1, 0, 0}));
  const std::string text = table(measure::summarise(kInfo, {&run, 1}));
  EXPECT_EQ(std::ranges::count(text, '\n'), 2 + 3) << text;
  EXPECT_THAT(text, testing::HasSubstr("observer"));
}

TEST(Table, AnUnseenObjectIsADashNotAZero) {
  measure::RunRecord run = measure::samples::quiet_run();
  EXPECT_THAT(table(measure::summarise(kInfo, {&run, 1})), testing::HasSubstr(" - "));
}

std::size_t width_of(const std::string& line) {
  return static_cast<std::size_t>(std::ranges::count_if(line, [](char c) { return (c & 0xc0) != 0x80; }));
}

TEST(ObjectsTable, ListsTheWorstFirstAndMarksThePrincipal) {
  const auto lines = lines_of(objects_table(measure::summarise(kInfo, measure::samples::zigzag_sweep())));
  ASSERT_EQ(lines.size(), 3u + 2u + 1u);
  EXPECT_EQ(lines[5], "at rest: every ghost is where its object is");
  EXPECT_THAT(lines[3], testing::StartsWith("*  CAR     a"));
  EXPECT_THAT(lines[4], testing::StartsWith("   CUBE    b"));
  EXPECT_THAT(lines[3], testing::HasSubstr("5.0")) << "updates a run";
  EXPECT_THAT(lines[4], testing::EndsWith("0.000  0.000  0.000"));
}

TEST(ObjectsTable, TakesMeansOfMeansAndTheGreatestOfTheRest) {
  measure::RunRecord run = measure::samples::quiet_run();
  for (int i = 0; i < 4; ++i)
    run.ghost_samples.push_back(ghost_sample(i, measure::samples::kB, kCar, {0, 0, 0}, {1, 0, 0}));
  for (int i = 0; i < 4; ++i)
    run.ghost_samples.push_back(ghost_sample(i, measure::samples::kC, kCar, {0, 0, 0}, {3, 0, 0}));
  const auto columns =
      object_columns(measure::summarise(kInfo, {&run, 1}), 1, [](double m) { return std::to_string(m); });
  EXPECT_EQ(columns[4].cells.front(), "2.000000");
  EXPECT_EQ(columns[5].cells.front(), "3.000000");
  EXPECT_EQ(columns[6].cells.front(), "3.000000");
}

TEST(ObjectsTable, FitsATerminalAndSaysHowManyMore) {
  measure::RunRecord run = measure::samples::zigzag_run(0.1);
  run.peers[1].name = "the-peer-with-a-long-name";
  for (std::uint32_t i = 0; i < 60; ++i) {
    run.objects.push_back(
        {ObjectId{100 + i}, "A_HALL/WITH_LONG_NAMES/ÜBER_ALLE/OBJECT_" + std::to_string(i), measure::samples::kB});
  }
  const auto lines = lines_of(objects_table(measure::summarise(kInfo, {&run, 1})));
  for (const std::string& line : lines) EXPECT_LE(width_of(line), 80u) << line;
  EXPECT_EQ(lines[lines.size() - 2], "and 50 more, in report.html and summary.json");
  EXPECT_THAT(lines[6], testing::HasSubstr("OBJECT_1")) << "the end of a path tells objects apart";
}

TEST(ObjectsTable, NamesTheWorstThatIsAtRest) {
  measure::RunRecord run = measure::samples::quiet_run();
  for (int i = 0; i < 5; ++i)
    run.ghost_samples.push_back(ghost_sample(i, measure::samples::kB, kCar, {0, 0, 0}, {0.25, 0, 0}));
  EXPECT_EQ(lines_of(objects_table(measure::summarise(kInfo, {&run, 1}))).back(),
            "at rest, the worst: CAR at b, 0.250000 m");
}

TEST(ObjectsTable, OfOneObjectIsLeftOut) {
  measure::RunRecord run = measure::samples::quiet_run();
  run.objects.resize(1);
  EXPECT_EQ(objects_table(measure::summarise(kInfo, {&run, 1})), "");
  EXPECT_EQ(objects_table(measure::summarise(kInfo, {})), "");
}

TEST(ContactsLines, SayHowManyAndHowDeep) {
  measure::RunRecord run = measure::samples::quiet_run();
  EXPECT_EQ(contacts_lines(measure::summarise(kInfo, {&run, 1})), "") << "nothing has met";
  run.contacts.push_back({2.0, measure::samples::kA, "owner", kCar, measure::samples::kWall, Vec3::UnitX(), 2.0});
  measure::ContactsMeasured& c = run.contacts_measured.emplace();
  run.counters["island_objects_max"] = 6;
  EXPECT_EQ(contacts_lines(measure::summarise(kInfo, {&run, 1})),
            "contacts: 1, at most 1 in a second, none in the last, islands of up to 6,\n  deepest overlap none\n");
  c.truth = {.depth_m = 2e-4, .a = "BALL_3", .b = "CRATE_1", .at_s = 2.4};
  c.views = {.depth_m = 0.04, .a = "BALL_3", .b = "CRATE_1", .at_s = 2.5};
  c.observer = "ada";
  c.energy_samples = c.bodies = 1;
  c.kinetic = {.start_j = 1.0, .greatest_j = 2.5, .end_j = 0.0};
  const auto summary = measure::summarise(kInfo, {&run, 1});
  EXPECT_EQ(
      contacts_line(summary["runs"][0]),
      "1, at most 1 in a second, none in the last, islands of up to 6, deepest overlap 200.0 µm (BALL_3 and CRATE_1 "
      "at 2.40 s), of ghosts 40.0 mm (BALL_3 and CRATE_1 at 2.50 s, at ada), kinetic energy 1.000 J at first, 2.500 "
      "J at most, 0.000 J at last");
  for (const std::string& line : lines_of(contacts_lines(summary))) EXPECT_LE(width_of(line), 100u) << line;
}

TEST(Table, SaysWhatTheNetworkIsThatNoColumnShows) {
  std::vector<measure::RunRecord> runs = measure::samples::zigzag_sweep();
  for (measure::RunRecord& run : runs) {
    run.network_settings = {{"network.latency_ms", run.params.at("network.latency_ms")},
                            {"network.jitter_ms", 20},
                            {"network.loss", 0.05},
                            {"network.link.a.b.loss", 0.25}};
  }
  const auto lines = lines_of(table(measure::summarise(kInfo, runs)));
  EXPECT_EQ(lines[1], "network: jitter 20 ms, loss 0.05, a to b: loss 0.25");
  for (int i = 0; i < 20; ++i) runs[0].network_settings["network.link.a.p" + std::to_string(i) + ".loss"] = 0.5;
  const measure::RunRecord& one = runs[0];
  for (const std::string& line : lines_of(table(measure::summarise(kInfo, {&one, 1})))) EXPECT_LE(width_of(line), 100u);
}

TEST(Table, ARealNetworkHasNoSettings) {
  measure::RunRecord run = measure::samples::zigzag_run(0.1);
  run.params = {{"network.loss", 0.05}};
  const measure::ScenarioInfo real{"zigzag", "real", 7, {}};
  EXPECT_THAT(table(measure::summarise(real, {&run, 1})), testing::Not(testing::HasSubstr("network:")));
}

TEST(Table, ThePrincipalObjectIsTheOneThatErrsMost) {
  const std::vector<measure::RunRecord> runs = measure::samples::zigzag_sweep();
  EXPECT_EQ(principal_object(measure::summarise(kInfo, runs)), "CAR");
  EXPECT_EQ(principal_object(measure::summarise(kInfo, {})), "");
}

}  // namespace peerd::report::table_test
