// configs/scenarios/town.toml: what lies about in the town, and what drives there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::town_test {

using namespace testing_support;

const std::string kTown = PEERD_SOURCE_DIR "/configs/scenarios/town.toml";

// The motions go on in a loop, and so the cars drive before the start, too, as soon as all peers know when that is.
TEST(Town, NothingOverlapsFromTheStart) {
  for (const char* latency_ms : {"0.05", "40"}) {
    const Ran ran = run_scenario(kTown, {"network.latency_ms=" + std::string(latency_ms), "duration_s=1"}).front();
    EXPECT_EQ(ran.summary["counters"]["contact_searches_overlapped"], 0) << latency_ms << " ms";
  }
}

// A crate that a car hits slides for some seconds, and lies until the next one comes.
TEST(Town, CratesSlideToRest) {
  const auto world = must(config::load_world(PEERD_SOURCE_DIR "/configs/worlds/town.wrl"));
  const Ran ran = run_scenario(kTown, {"duration_s=40"}).front();
  std::size_t samples = 0, moving = 0;
  for (const PeerLog& log : ran.logs) {
    for (const auto& sample : log.object_samples) {
      if (sample.owner != log.peer || !world.scene.path_of(sample.object).starts_with("CRATE_")) continue;
      ++samples;
      moving += sample.state.velocity.norm() > 0.01 ? 1 : 0;
    }
  }
  ASSERT_GT(samples, 5000u);
  const double share = static_cast<double>(moving) / static_cast<double>(samples);
  RecordProperty("moving", std::to_string(share));
  EXPECT_GT(share, 0.02) << "no car hits them";
  EXPECT_LT(share, 0.25);
}

}  // namespace peerd::sim::town_test
