#include "peerd/lab/measure/pareto.hpp"

#include <gmock/gmock.h>

#include "peerd/lab/report/figures.hpp"
#include "tests/must.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::measure::pareto_test {

using Json = nlohmann::ordered_json;

Json row(const char* path, double mean_m, std::size_t samples = 10) {
  return {{"path", path}, {"samples", samples}, {"ghost_error_m", {{"mean", mean_m}, {"max", 2.0 * mean_m}}}};
}
Json run(Json params, std::vector<Json> objects, double bytes_per_s) {
  return {{"params", std::move(params)}, {"objects", std::move(objects)}, {"traffic", {{"bytes_per_s", bytes_per_s}}}};
}
Json summary_of(std::vector<Json> runs) { return {{"scenario", "s"}, {"runs", std::move(runs)}}; }

std::vector<std::size_t> front_of(const Situation& situation) {
  std::vector<std::size_t> runs;
  for (const RunCost& r : situation.runs) {
    if (r.on_front) runs.push_back(r.run);
  }
  return runs;
}

TEST(Pareto, FrontHoldsWhatNoOtherBeats) {
  std::vector<Json> runs;
  const std::vector<std::pair<double, double>> error_and_bytes{{0.5, 100}, {0.2, 300}, {0.6, 100},
                                                               {0.2, 300}, {0.3, 200}, {0.31, 250}};
  for (std::size_t i = 0; i < error_and_bytes.size(); ++i) {
    const auto [error_m, bytes_per_s] = error_and_bytes[i];
    runs.push_back(run({{"replication.order", i}}, {row("CAR", error_m)}, bytes_per_s));
  }
  const auto situation = only(pareto_fronts(summary_of(runs)));
  EXPECT_EQ(situation.label, "");
  EXPECT_THAT(front_of(situation), testing::ElementsAre(0, 1, 3, 4));  // equals both stay
}

TEST(Pareto, NetworksAreNotChosen) {
  const Json summary =
      summary_of({run({{"network.latency_ms", 5}, {"replication.order", 1}}, {row("CAR", 0.1)}, 100),
                  run({{"network.latency_ms", 500}, {"replication.order", 1}}, {row("CAR", 0.9)}, 120),
                  run({{"network.latency_ms", 500}, {"replication.order", 2}}, {row("CAR", 0.8)}, 110)});
  const std::vector<Situation> situations = pareto_fronts(summary);
  ASSERT_EQ(situations.size(), 2u);
  EXPECT_EQ(situations[0].label, "latency 5 ms");
  EXPECT_EQ(situations[1].label, "latency 500 ms");
  EXPECT_THAT(front_of(situations[0]), testing::ElementsAre(0));
  EXPECT_THAT(front_of(situations[1]), testing::ElementsAre(2));
}

// A run in which nobody saw the object counts neither: no samples is not no error.
TEST(Pareto, WhatStandsStillDoesNotThinOutTheError) {
  const Json summary = summary_of({run(Json::object(), {row("CAR", 0.4), row("CAR", 0.2), row("WALL", 0.0)}, 100),
                                   run(Json::object(), {row("CAR", 0.4), row("CAR", 0.0, 0)}, 100),
                                   run(Json::object(), {row("CAR", 0.0, 0)}, 100)});
  const auto situation = only(pareto_fronts(summary));
  ASSERT_EQ(situation.runs.size(), 2u);
  EXPECT_DOUBLE_EQ(situation.runs[0].error_m, 0.3);
  EXPECT_DOUBLE_EQ(situation.runs[1].error_m, 0.4);
}

TEST(ParetoFigure, NeedsTwoRunsOfOneNetwork) {
  std::vector<Json> runs{run({{"network.latency_ms", 5}, {"replication.order", 1}}, {row("CAR", 0.1)}, 100),
                         run({{"network.latency_ms", 500}, {"replication.order", 1}}, {row("CAR", 0.9)}, 120)};
  EXPECT_TRUE(report::pareto_figure(summary_of(runs)).is_null());
  runs.push_back(run({{"network.latency_ms", 5}, {"replication.order", 2}}, {row("CAR", 0.0)}, 100));
  const auto axis_y = [&] { return report::pareto_figure(summary_of(runs)).at("cells")[0].at("panels")[0].at("y"); };
  EXPECT_FALSE(axis_y().contains("log")) << "no logarithm of 0";
  runs.back() = run({{"network.latency_ms", 5}, {"replication.order", 2}}, {row("CAR", 0.01)}, 100);
  EXPECT_TRUE(axis_y().contains("log"));
}

}  // namespace peerd::measure::pareto_test
