#include "peerd/lab/baselines/game_client.hpp"

#include <gtest/gtest.h>

#include "peerd/lab/measure/lookup.hpp"
#include "tests/peerd/lab/baselines/systems.hpp"

namespace peerd::baselines::game_client_test {

using namespace testing_support;
using sim::testing_support::kEq47;

constexpr PeerId kB{2};
constexpr double kCar_m_s = 8.5;

TEST(GameClient, WithPredictionSeesItsOwnObjectAtOnce) {
  const auto record = run_system(kEq47, "server", {"network.latency_ms=200"});
  EXPECT_LT(mean_m(record, kB, seen_error_m), 0.01);
}

TEST(GameClient, WithoutPredictionSeesItsOwnObjectAsLateAsTheServerSaysIt) {
  const auto record = run_system(kEq47, "server-bare", {"network.latency_ms=200"});
  EXPECT_GT(mean_m(record, kB, seen_error_m), 0.4 * kCar_m_s);
  EXPECT_LT(mean_m(record, kB, measure::view_difference_m), 0.01) << "everybody sees the server's past";
}

TEST(GameClient, StaysWithTheServerThoughInputsAreLost) {
  const auto record = run_system(kEq47, "server", {"network.latency_ms=50", "network.loss=0.4"});
  EXPECT_GT(record.counters.at("inputs_lost"), 0u) << "three in a row";
  EXPECT_LT(mean_m(record, kB, seen_error_m), 0.2);
  EXPECT_LT(mean_m(record, kB, measure::shown_error_m), 0.6 * kCar_m_s);
}

// A hundred walkers are in four blocks, whose snapshots come at times of their own where the delay varies.
TEST(GameClient, ItsOwnObjectsOfAllBlocksAreWhereItsInputsBringThem) {
  const auto record = run_system(PEERD_SOURCE_DIR "/configs/scenarios/crowd.toml", "server",
                                 {"duration_s=5", "network.latency_ms=50", "network.jitter_ms=30"});
  EXPECT_LT(mean_m(record, kB, seen_error_m), 0.01);
  EXPECT_LT(mean_m(record, PeerId{3}, seen_error_m), 0.01);
}

TEST(GameClient, InterpolatesNoMoreThanItIsAskedTo) {
  const auto late_m = [](const char* interpolation) {
    return mean_m(run_system(kEq47, "server", {interpolation, "network.latency_ms=50"}), kB, measure::shown_error_m);
  };
  EXPECT_NEAR(late_m("baseline.interpolation_ms=300") - late_m("baseline.interpolation_ms=100"), 0.2 * kCar_m_s, 0.1);
}

}  // namespace peerd::baselines::game_client_test
