#include "peerd/lab/measure/csv.hpp"

#include <gmock/gmock.h>

#include <charconv>
#include <sstream>

#include "tests/peerd/report_samples.hpp"

namespace peerd::measure::csv_test {

using samples::ghost_sample, samples::kA, samples::kB, samples::kCar, samples::kWall;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

TEST(Csv, EveryRowHasTheCellsOfTheHeading) {
  const std::vector<RunRecord> runs = samples::zigzag_sweep();
  for (const std::string& text : {errors_csv(runs), traffic_csv(runs), collisions_csv(runs)}) {
    const std::vector<std::string> lines = lines_of(text);
    EXPECT_EQ(text.back(), '\n');
    for (const std::string& line : lines) {
      EXPECT_EQ(cells_of(line).size(), cells_of(lines.front()).size()) << line;
    }
  }
}

TEST(Csv, RowCounts) {
  const std::vector<RunRecord> runs = samples::zigzag_sweep();
  EXPECT_EQ(lines_of(errors_csv(runs)).size(), 1u + 6u * 4u * 100u);
  EXPECT_EQ(lines_of(traffic_csv(runs)).size(), 1u + 6u * (6u + 5u));
  EXPECT_EQ(lines_of(collisions_csv(runs)).size(), 1u + 6u * 2u);
  EXPECT_EQ(lines_of(errors_csv({})).size(), 1u);
}

// 24 views of 100 samples each.
TEST(Csv, ErrorsAreThinnedEvenly) {
  const std::vector<RunRecord> runs = samples::zigzag_sweep();
  const std::vector<std::string> all = lines_of(errors_csv(runs)), few = lines_of(errors_csv(runs, 600));
  const RowCount count = errors_rows(runs, 600);
  EXPECT_EQ(few.size(), 1u + count.written);
  EXPECT_EQ(count.of, 2400u);
  EXPECT_EQ(count.written, 600u) << "every fourth row of every view";
  for (std::size_t i = 0; i < count.written; ++i) EXPECT_EQ(few[1 + i], all[1 + 4 * i]);
  EXPECT_EQ(errors_csv(runs, 2400), errors_csv(runs));
}

TEST(Csv, WhereViewsAreManySomeAreLeftOut) {
  const std::vector<RunRecord> runs = samples::zigzag_sweep();
  const RowCount count = errors_rows(runs, 100);
  EXPECT_LE(count.written, 100u);
  EXPECT_GE(count.written, 60u);
  EXPECT_EQ(lines_of(errors_csv(runs, 100)).size(), 1u + count.written);
  EXPECT_EQ(lines_of(errors_csv(runs, 1)).size(), 1u + errors_rows(runs, 1).written);
  EXPECT_LE(errors_rows(runs, 1).written, 1u);
}

TEST(Csv, NoRowsOnRequest) {
  const std::vector<RunRecord> runs = samples::zigzag_sweep();
  EXPECT_EQ(lines_of(errors_csv(runs, 0)).size(), 1u);
  EXPECT_EQ(lines_of(traffic_csv(runs, 0)).size(), 1u);
  EXPECT_EQ(errors_rows(runs, 0).written, 0u);
  EXPECT_EQ(traffic_rows(runs, 0).written, 0u);
  EXPECT_EQ(traffic_rows(runs, 0).of, 66u);
}

TEST(Csv, TrafficIsThinnedRowByRow) {
  const std::vector<RunRecord> runs = samples::zigzag_sweep();
  const std::vector<std::string> all = lines_of(traffic_csv(runs)), few = lines_of(traffic_csv(runs, 33));
  ASSERT_EQ(few.size(), 34u);
  EXPECT_EQ(traffic_rows(runs, 33).written, 33u);
  for (std::size_t i = 0; i < 33; ++i) EXPECT_EQ(few[1 + i], all[1 + 2 * i]);
}

TEST(Csv, NumbersReadBackToTheSameBits) {
  RunRecord run = samples::quiet_run();
  const double awkward = 0.1 + 0.2;
  run.ghost_samples = {ghost_sample(1.0 / 3.0, kB, kCar, {awkward, -0.0, 1e-300}, {awkward, 0, 0})};
  const std::vector<std::string> cells = cells_of(lines_of(errors_csv({&run, 1}))[1]);
  const auto value = [&](std::size_t i) {
    double v = 0.0;
    std::from_chars(cells[i].data(), cells[i].data() + cells[i].size(), v);
    return v;
  };
  EXPECT_EQ(cells[0], "1");
  EXPECT_EQ(value(1), 1.0 / 3.0);
  EXPECT_EQ(cells[2], "b");
  EXPECT_EQ(cells[3], "CAR");
  EXPECT_EQ(cells[4], "0.30000000000000004");
  EXPECT_EQ(value(6), 1e-300);
}

TEST(Csv, NamesWithCommasAndQuotesAreQuoted) {
  RunRecord run = samples::quiet_run();
  run.objects[0].path = "A,\"B\"";
  run.updates = {{0, kA, kCar, 31, 0.5, "first"}};
  EXPECT_EQ(lines_of(traffic_csv({&run, 1}))[1], "1,0,a,update,\"A,\"\"B\"\"\",31,0.5,first");
}

TEST(Csv, TrafficIsInOrderOfTimeUpdatesFirst) {
  RunRecord run = samples::quiet_run();
  run.updates = {{1, kA, kCar, 31, 0.5, "error"}, {3, kA, kCar, 31, 0.01, "error"}};
  run.datagrams = {{2, kB, 70}, {1, kA, 98}};
  EXPECT_THAT(
      lines_of(traffic_csv({&run, 1})),
      testing::ElementsAre("run,t_s,sender,kind,object,bytes,threshold_m,reason", "1,1,a,update,CAR,31,0.5,error",
                           "1,1,a,datagram,,98,,", "1,2,b,datagram,,70,,", "1,3,a,update,CAR,31,0.01,error"));
}

TEST(Csv, CollisionsCarryTheirVerdict) {
  const RunRecord run = samples::zigzag_run(0.1);
  EXPECT_THAT(lines_of(collisions_csv({&run, 1})),
              testing::ElementsAre(testing::_, "1,2,a,owner,CAR,#17,1,0,0,2.01,outcome,witness,0,",
                                   "1,2.1,b,predicted,CAR,#17,1,0,0,2.15,agreed,witness,0,"));
}

TEST(Csv, CollisionsCarryTheTypeAndThePolygons) {
  RunRecord run = samples::zigzag_run(0.1);
  run.scene_paths[ObjectId{17}] = "WALL";
  run.scene_paths[ObjectId{18}] = "WALL/0";
  run.contacts[0].type = CollisionType::kAllPairs;
  run.contacts[0].polygons = {70, {{{kCar, 3}, {ObjectId{18}, 1}}, {{kCar, 4}, {ObjectId{18}, 1}}}};
  run.contacts[1].type = CollisionType::kBox;
  const auto lines = lines_of(collisions_csv({&run, 1}));
  EXPECT_THAT(lines[0], testing::EndsWith(",verdict,type,polygon_pairs,polygons"));
  EXPECT_THAT(lines[1], testing::EndsWith(",outcome,allpairs,70,CAR 3 - WALL/0 1; CAR 4 - WALL/0 1"));
  EXPECT_THAT(lines[2], testing::EndsWith(",agreed,box,0,"));
}

}  // namespace peerd::measure::csv_test
