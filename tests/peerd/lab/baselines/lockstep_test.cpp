#include "peerd/lab/baselines/lockstep.hpp"

#include <gtest/gtest.h>

#include "peerd/lab/measure/lookup.hpp"
#include "tests/peerd/lab/baselines/systems.hpp"

namespace peerd::baselines::lockstep_test {

using namespace testing_support;
using sim::testing_support::kEq47;

constexpr PeerId kB{2};
constexpr double kCar_m_s = 8.5;

// The others' inputs are under way for 0.1 s, and wait for the next of 35 ticks a second.
TEST(LockstepPlayer, ShowsEverybodyTheSameAsLateAsTheNetwork) {
  const auto record = run_system(kEq47, "lockstep", {"network.latency_ms=100"});
  EXPECT_NEAR(mean_m(record, kB, measure::shown_error_m), 0.130 * kCar_m_s, 0.02 * kCar_m_s);
  EXPECT_NEAR(mean_m(record, kB, seen_error_m), 0.130 * kCar_m_s, 0.02 * kCar_m_s);
  EXPECT_LT(mean_m(record, kB, measure::view_difference_m), 1e-9);
}

TEST(LockstepPlayer, WaitsForTheSlowest) {
  const auto record = run_system(kEq47, "lockstep", {"network.latency_ms=20", "network.link.b.a.latency_ms=300"});
  EXPECT_GT(mean_m(record, kB, seen_error_m), 0.3 * kCar_m_s) << "a runs a tick once it has the inputs of b";
  EXPECT_LT(mean_m(record, kB, measure::shown_error_m), 0.1 * kCar_m_s) << "b has those of a long before";
}

TEST(LockstepPlayer, AsksForWhatIsLost) {
  const auto record =
      run_system(kEq47, "lockstep", {"network.latency_ms=50", "network.loss=0.2", "network.jitter_ms=30"});
  EXPECT_GE(record.counters.at("ticks"), record.peers.size() * 15u * 35u)
      << "everybody has run all ticks until the end";
  EXPECT_LT(mean_m(record, kB, measure::shown_error_m), 0.6 * kCar_m_s);
  EXPECT_FALSE(record.counters.contains("datagrams_refused"));
}

TEST(LockstepPlayer, AgreesOnACollisionWithoutAWord) {
  const auto record = run_system(kMeeting, "lockstep");
  const auto decided = contacts_of(record, "a", "decided");
  ASSERT_FALSE(decided.empty());
  for (const char* peer : {"b", "c"}) {
    const auto applied = contacts_of(record, peer, "applied");
    ASSERT_EQ(applied.size(), decided.size()) << peer;
    for (std::size_t i = 0; i < decided.size(); ++i) {
      EXPECT_EQ(applied[i].t_s, decided[i].t_s);
      EXPECT_EQ(applied[i].normal, decided[i].normal);
    }
  }
}

}  // namespace peerd::baselines::lockstep_test
