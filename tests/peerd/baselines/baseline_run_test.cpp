#include "peerd/baselines/baseline_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "peerd/measure/lookup.hpp"
#include "peerd/measure/summary.hpp"
#include "tests/peerd/baselines/systems.hpp"

namespace peerd::baselines::baseline_run_test {

using namespace testing_support;
using testing::HasSubstr;

TEST(BaselineRun, IsTheSameForTheSameSeed) {
  for (const char* system : {"lockstep", "server"}) {
    const auto text = [&](const char* seed) {
      const auto record = run_system(kMeeting, system, {"network.loss=0.1", "network.jitter_ms=40", seed});
      return report::summarise({"meeting", "sim", 1, {}}, {&record, 1}).dump();
    };
    EXPECT_EQ(text("seed=1"), text("seed=1")) << system;
    EXPECT_NE(text("seed=1"), text("seed=2")) << system;
  }
}

TEST(BaselineRun, RefusesWhatOtherSystemsDoNotHave) {
  const auto why = [](std::vector<std::string> sets) {
    const auto record = try_system(kMeeting, "server", std::move(sets));
    return record ? std::string("it ran") : record.error().text;
  };
  EXPECT_THAT(why({"event.late.at_s=2", "event.late.kind=leave", "event.late.peer=b"}), HasSubstr("join or leave"));
  EXPECT_THAT(why({"event.away.at_s=2", "event.away.kind=remove", "event.away.peer=a", "event.away.path=LEFT"}),
              HasSubstr("edits the scene"));
}

TEST(BaselineRun, APartitionStopsWhoIsAwayFromTheServer) {
  const auto shown_late_m = [](std::vector<std::string> sets) {
    const auto record = run_system(sim::testing_support::kEq47, "server", std::move(sets));
    return mean_m(record, PeerId{2}, report::shown_error_m);
  };
  EXPECT_GT(shown_late_m({"event.apart.at_s=5", "event.apart.kind=partition", "event.apart.groups=[[\"a\"],[\"b\"]]"}),
            10.0 * shown_late_m({}));
}

TEST(BaselineRun, WithoutASystemItIsTheProjectsOwn) {
  const auto record = run_system(kMeeting, "dis");
  EXPECT_EQ(record.peers.size(), 3u);
  EXPECT_GT(record.counters.at("updates_out"), 0u);
}

}  // namespace peerd::baselines::baseline_run_test
