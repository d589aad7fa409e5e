// Decisions that arrive after their consequences.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::late_decisions_test {

using testing_support::Ran;
using testing_support::run_scenario;

// How the last observer sees the object at the end of the run.
const measure::GhostSample& end_of(const Ran& ran, const std::string& path) {
  const auto object = std::ranges::find(ran.record.objects, path, &measure::ObjectInfo::path);
  const auto& samples = ran.record.ghost_samples;
  return *std::ranges::find(samples.rbegin(), samples.rend(), object->object, &measure::GhostSample::object);
}

// b hears late that its first ball was struck. That one has run into its second ball by then, of which b has published
// that it is at rest.
TEST(LateDecisions, SendAnOwnObjectIntoAnotherOneWhenItHappened) {
  const auto run = [](int latency_ms) {
    return run_scenario(PEERD_SOURCE_DIR "/tests/sim/worlds/chain.toml",
                        {"network.latency_ms=" + std::to_string(latency_ms)})
        .front();
  };
  const Vec3 at_once = end_of(run(0), "SECOND").truth.position;
  ASSERT_GT(at_once.x(), 1.0) << "the first ball hits it";
  for (const int latency_ms : {50, 100, 200, 300}) {
    SCOPED_TRACE(latency_ms);
    const Ran ran = run(latency_ms);
    EXPECT_LT((end_of(ran, "SECOND").truth.position - at_once).norm(), 1e-6);
    for (const std::string path : {"FIRST", "SECOND"}) {
      EXPECT_EQ(end_of(ran, path).ghost.position, end_of(ran, path).truth.position) << path;
    }
  }
}

}  // namespace peerd::sim::late_decisions_test
