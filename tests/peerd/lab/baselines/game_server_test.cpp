#include "peerd/lab/baselines/game_server.hpp"

#include <gtest/gtest.h>

#include "peerd/lab/measure/lookup.hpp"
#include "tests/peerd/lab/baselines/systems.hpp"

namespace peerd::baselines::game_server_test {

using namespace testing_support;
using sim::testing_support::kEq47;

constexpr PeerId kB{2};
constexpr double kCar_m_s = 8.5;

TEST(GameServer, DecidesWhatTwoPlayersObjectsDo) {
  const auto record = run_system(kMeeting, "server");
  const auto decided = contacts_of(record, "server", "decided");
  ASSERT_FALSE(decided.empty());
  for (const char* peer : {"a", "b", "c"}) {
    EXPECT_EQ(contacts_of(record, peer, "applied").size(), decided.size()) << peer;
    EXPECT_TRUE(contacts_of(record, peer, "decided").empty()) << peer;
  }
}

TEST(GameServer, GivesEveryContactToEverybodyThoughMuchIsLost) {
  const auto record = run_system(kMeeting, "server", {"network.loss=0.3"});
  const auto decided = contacts_of(record, "server", "decided");
  ASSERT_FALSE(decided.empty());
  for (const char* peer : {"a", "b", "c"}) EXPECT_EQ(contacts_of(record, peer, "applied").size(), decided.size());
}

// Inputs take one way to the server, snapshots another one back; they leave 20 times a second, and interpolation shows
// them 0.1 s later.
TEST(GameServer, OthersAreSeenAfterBothWaysAndTheInterpolation) {
  const auto record = run_system(kEq47, "server", {"network.latency_ms=100"});
  const double late_s = mean_m(record, kB, measure::shown_error_m) / kCar_m_s;
  EXPECT_GT(late_s, 0.29);
  EXPECT_LT(late_s, 0.37);
}

// The cubes of eq47 stand. Where acknowledgements come, their state travels at the beginning alone.
TEST(GameServer, SendsOnlyWhatHasChanged) {
  const auto record = run_system(kEq47, "server", {"network.latency_ms=50"});
  std::size_t of_car = 0;
  for (const measure::UpdateSent& update : record.updates) {
    if (update.reason != "snapshot" || update.t_s < 1.0) continue;
    const auto object = std::ranges::find(record.objects, update.object, &measure::ObjectInfo::object);
    ASSERT_NE(object, record.objects.end());
    ASSERT_EQ(object->path, "CAR") << update.t_s << " s";
    ++of_car;
  }
  EXPECT_GE(of_car, 14u * 20u) << "to each client";
  EXPECT_GT(record.objects.size(), 1u);
}

}  // namespace peerd::baselines::game_server_test
