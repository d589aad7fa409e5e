#include "peerd/lab/measure/network_measured.hpp"

#include <gtest/gtest.h>

#include "peerd/lab/measure/summary.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::measure::network_measured_test {

const ScenarioInfo kInfo{"zigzag", "real", 7, {}};

TEST(KeptTime, ARunCountsWhereTheComputerKeptTime) {
  struct Case {
    double before_ms, during_ms;
    bool steady;
  };
  RunRecord run = samples::quiet_run();
  for (const Case& c : {Case{10, 50, true}, Case{10.1, 50, false}, Case{10, 50.1, false}}) {
    run.network = {.links = {}, .oversleep_before_ms = {0, c.before_ms}, .oversleep_during_ms = {0, c.during_ms}};
    EXPECT_EQ(kept_time(*run.network), c.steady);
    EXPECT_EQ(summarise(kInfo, {&run, 1})["runs"][0]["network"]["steady"], c.steady);
  }
}

TEST(KeptTime, OneLateTimerOfAHundredIsForgiven) {
  NetworkMeasured network;
  network.oversleep_before_ms.assign(100, 0.1);
  network.oversleep_during_ms.assign(100, 0.1);
  network.oversleep_before_ms.front() = network.oversleep_during_ms.front() = 1000.0;
  EXPECT_TRUE(kept_time(network));
  network.oversleep_before_ms.back() = 1000.0;
  EXPECT_FALSE(kept_time(network));
}

}  // namespace peerd::measure::network_measured_test
