#include "peerd/view/picks/surroundings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/peerd/view/picture/two_peers.hpp"

namespace peerd::view::surroundings_test {

using nlohmann::ordered_json;
using peerd::testing_support::TwoPeers;
using testing::SizeIs;

// Two spheres, one of each peer, that come towards each other along x at 2 m/s each.
const std::string kWorld = R"(
DEF A Transform { distanceThreshold 0.5 children Shape { geometry Sphere { radius 1 } } }
DEF B Transform { translation 40 0 0 distanceThreshold 0.5 children Shape { geometry Sphere { radius 1 } } }
CollisionInterest { objectPath "A" interests "B" }
)";

config::RunSettings settings(double cell_m) {
  config::RunSettings run;
  run.replication.regions.cell_m = cell_m;
  run.replication.regions.regions = {4, 1, 4};
  testing_support::add_movers(run, {.x = "2*t"}, {.x = "40 - 2*t"});
  return run;
}

ordered_json surroundings_of(TwoPeers& peers) {
  PeerNode& node = *peers.nodes[0];
  const auto at = node.advance_view(peers.now, std::nullopt);
  if (!at) throw std::runtime_error("there is no session");
  return surroundings(node, *at, std::vector{peers.find("A"), peers.find("B")});
}

TEST(Surroundings, HaveTheRegionsThatThePeerHasJoined) {
  TwoPeers peers(kWorld, settings(10.0));
  peers.run_until(1.0);
  const ordered_json reply = surroundings_of(peers);
  const ordered_json& regions = reply["regions"];
  EXPECT_EQ(regions["cell_m"], 10.0);
  EXPECT_EQ(regions["counts"], ordered_json({4, 1, 4}));
  EXPECT_EQ(regions["joined"], ordered_json({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16}))
      << "it has no area of interest, so it receives everything";
  EXPECT_EQ(regions["published"], ordered_json::array({1})) << "A is at x = 2";
}

TEST(Surroundings, HaveNoRegionsOfAnUncutScene) {
  TwoPeers peers(kWorld, settings(0.0));
  peers.run_until(1.0);
  const ordered_json reply = surroundings_of(peers);
  EXPECT_EQ(reply["regions"]["cell_m"], 0.0);
  EXPECT_EQ(reply["regions"]["published"], ordered_json::array());
}

// Far apart the spheres do not meet, and the threshold is the usual one; shortly before the contact it is tight.
TEST(Surroundings, HaveTheSpheresThatTightenThresholds) {
  TwoPeers peers(kWorld, settings(0.0));
  peers.run_until(2.0);
  const ordered_json far = surroundings_of(peers)["proximity"];
  ASSERT_THAT(far["objects"], SizeIs(2));
  const double close_s = far["close_s"];
  for (const auto& object : far["objects"]) {
    EXPECT_NEAR(object["radius_m"].get<double>(), 1.0, 0.01);
    EXPECT_NEAR(object["range_m"].get<double>(), 2.0 * close_s, 0.1);
    EXPECT_EQ(object["tight"], false);
  }
  peers.run_until(9.4);  // they touch at 9.5 s
  const ordered_json near = surroundings_of(peers)["proximity"];
  EXPECT_EQ(near["objects"][0]["tight"], true) << near.dump();
  EXPECT_EQ(near["objects"][0]["node"], 0);
}

}  // namespace peerd::view::surroundings_test
