// What a peer of a large session costs does not grow with the world: twice as many peers in a world twice as large, of
// which each sees as much as before.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "bench/fitted_exponent.hpp"
#include "bench/islands/island_run.hpp"
#include "peerd/lab/sim/simulation.hpp"
#include "peerd/peer/config/scenario.hpp"

namespace peerd::sim::large_session_test {

using bench::IslandCosts;
using bench::IslandWorld;
using bench::run_islands;

IslandCosts costs_of(std::uint32_t peers, const std::vector<std::string>& sets) {
  IslandWorld world;
  world.peers = peers;
  world.objects = 3;
  world.islands = 6;
  world.together = 9;
  world.settle_s = 13.0;  // 81 peers' far hellos are at most 12.2 s apart
  world.measure_s = 4.0;
  world.sets = sets;
  return run_islands(world);
}

// With the threshold at 16 both are large; what they receive differs by how many of them are at the border of the
// world.
TEST(LargeSession, TrafficOfAPeerDoesNotGrowWithTheWorld) {
  const std::vector<std::string> sets{"replication.large_session_above=16", "replication.far_hellos_per_s=10"};
  const IslandCosts small = costs_of(36, sets), twice = costs_of(81, sets);
  EXPECT_EQ(small.wrong, "");
  EXPECT_EQ(twice.wrong, "");
  EXPECT_GT(small.received_objects, 0.0);
  const auto of_each_near = [](const IslandCosts& costs) { return costs.in_all.bytes / costs.near_members; };
  EXPECT_LT(bench::fitted_exponent({{36.0, of_each_near(small)}, {81.0, of_each_near(twice)}}), 0.3);
  EXPECT_LT(twice.near_members, 26.0) << "the peers of the 25 squares around, and the leader";
  EXPECT_GT(twice.in.at("hello").datagrams, twice.near_members - 1.0) << "each near peer says hello once a second";
  EXPECT_LT(twice.in.at("far_hello").datagrams, 15.0) << "of all together, with those of the leader";
  EXPECT_LT(twice.clock_error_ms, 20.0);
}

// The same sessions, as if they were small: the traffic grows, so that the test above can fail.
TEST(LargeSession, WithoutItTrafficGrows) {
  const std::vector<std::string> sets{"replication.large_session_above=0"};
  const IslandCosts small = costs_of(36, sets), twice = costs_of(81, sets);
  EXPECT_EQ(small.wrong, "");
  EXPECT_GT(bench::fitted_exponent({{36.0, small.in_all.bytes}, {81.0, twice.in_all.bytes}}), 0.5);
}

// Sees who is here in a session whose leader dies, and which a peer joins after that.
class AfterALeadersDeath final : public PeersWatch {
 public:
  explicit AfterALeadersDeath(std::size_t joining) : joining_(joining) {}

  [[nodiscard]] std::uint32_t rate_hz() const override { return 1; }
  void begin(SimTime, HostTime) override {}
  void see(double, std::span<const SeenPeer> peers) override {
    known.clear();
    offsets_ms.clear();
    std::optional<SimTime> first;
    for (const SeenPeer& peer : peers) {
      if (peer.node == nullptr) continue;
      const replication::Peer& each = peer.node->peer();
      known.push_back(each.members().count());
      large += each.members().is_large() ? 1 : 0;
      const SimTime now = each.clock().to_session(peer.host);
      if (!first) first = now;
      if (each.clock().synchronised()) offsets_ms.push_back(std::abs(to_seconds(now - *first)) * 1e3);
    }
    joined = peers[joining_].node != nullptr && peers[joining_].node->peer().clock().synchronised();
  }

  std::vector<std::size_t> known;
  std::vector<double> offsets_ms;
  std::size_t large = 0;
  bool joined = false;

 private:
  std::size_t joining_;
};

// The leader is killed without a word. The others have one time and one leader again, so that another peer can join.
TEST(LargeSession, GoesOnWhenItsLeaderDies) {
  IslandWorld world;
  world.peers = 16;
  world.objects = 2;
  world.islands = 4;
  world.together = 15;
  const std::filesystem::path folder = testing::TempDir() + "large_session";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "w.wrl") << bench::world_text(world);
  std::string text = bench::scenario_text(world, "w.wrl");
  const std::string joins_at = "at_s = 1\n";
  ASSERT_NE(text.find(joins_at), std::string::npos);
  text.replace(text.find(joins_at), joins_at.size(), "at_s = 12\n");
  text += "[event.death]\nkind = \"kill\"\npeer = \"p00000\"\nat_s = 6\n";
  config::ScenarioRequest request;
  request.file = folder / "s.toml";
  request.text = text;
  request.sets = {"replication.large_session_above=8", "replication.far_hellos_per_s=10", "duration_s=20"};
  const auto scenario = config::read_scenario(request);
  ASSERT_TRUE(scenario) << scenario.error().text;
  const auto shared = share_world(scenario->world, scenario->reading, scenario->runs);
  ASSERT_TRUE(shared) << shared.error().text;
  AfterALeadersDeath watch(15);
  const auto logs = simulate(scenario->runs.front(), **shared, {}, {}, nullptr, nullptr, nullptr, {}, &watch);
  ASSERT_TRUE(logs) << logs.error().text;
  EXPECT_GT(watch.large, 100u) << "else this is no test of it";
  EXPECT_TRUE(watch.joined);
  EXPECT_EQ(watch.known, std::vector<std::size_t>(15, 14));
  ASSERT_EQ(watch.offsets_ms.size(), 15u) << "all have session time";
  EXPECT_LT(std::ranges::max(watch.offsets_ms), 100.0);
}

}  // namespace peerd::sim::large_session_test
