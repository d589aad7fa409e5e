#include "peerd/lab/baselines/baseline_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "peerd/lab/measure/lookup.hpp"
#include "peerd/lab/measure/summary.hpp"
#include "tests/peerd/lab/baselines/systems.hpp"

namespace peerd::baselines::baseline_run_test {

using namespace testing_support;
using testing::HasSubstr;

TEST(BaselineRun, IsTheSameForTheSameSeed) {
  for (const char* system : {"lockstep", "server"}) {
    const auto text = [&](const char* seed) {
      const auto record = run_system(kMeeting, system, {"network.loss=0.1", "network.jitter_ms=40", seed});
      return measure::summarise({"meeting", "sim", 1, {}}, {&record, 1}).dump();
    };
    EXPECT_EQ(text("seed=1"), text("seed=1")) << system;
    EXPECT_NE(text("seed=1"), text("seed=2")) << system;
  }
}

// The greatest distance of an object's truth between two runs.
double farthest_m(const measure::RunRecord& one, const measure::RunRecord& other, const std::string& path) {
  const auto found = std::ranges::find(one.objects, path, &measure::ObjectInfo::path);
  if (found == one.objects.end()) throw std::runtime_error("nobody owns " + path);
  const ObjectId object = found->object;
  EXPECT_EQ(one.ghost_samples.size(), other.ghost_samples.size());
  double farthest_m = 0.0;
  for (std::size_t i = 0; i < std::min(one.ghost_samples.size(), other.ghost_samples.size()); ++i) {
    if (one.ghost_samples[i].object != object) continue;
    const Vec3 apart = one.ghost_samples[i].truth.position - other.ghost_samples[i].truth.position;
    farthest_m = std::max(farthest_m, apart.norm());
  }
  return farthest_m;
}

TEST(BaselineRun, KeysMoveWhatTheirPlayerOwns) {
  for (const char* system : {"lockstep", "server"}) {
    SCOPED_TRACE(system);
    const auto pressed = run_system(kKeys, system), not_by_a = run_system(kKeys, system, {"peer.a.key=[]"});
    EXPECT_GT(farthest_m(pressed, not_by_a, "RED"), 1.0);
    EXPECT_EQ(farthest_m(pressed, not_by_a, "RAMP/BLUE"), 0.0) << "b presses the same keys";
    EXPECT_FALSE(pressed.counters.contains("keys_without_effect"));
    const auto unheard = run_system(kKeys, system, {"peer.a.key=[{at_s = 1, key = \"F9\"}]"});
    EXPECT_EQ(unheard.counters.at("keys_without_effect"), 1u);
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
    return mean_m(record, PeerId{2}, measure::shown_error_m);
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
