#include "peerd/lab/chaos/world_text.hpp"

#include <gtest/gtest.h>

#include "peerd/peer/node/peer_node.hpp"

namespace peerd::chaos::world_text_test {

TEST(ChaosWorld, CanBeReadAndHasItsObjects) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const std::size_t peers = 1 + seed % 9;
    const ChaosWorld world = draw_world(seed, peers);
    ASSERT_EQ(world.owned.size(), peers);
    const auto shared = share(world);
    std::size_t objects = 0;
    for (const Instance& each : shared->world.scene.instances) objects += each.parent < 0 ? 1 : 0;
    EXPECT_EQ(objects, 54u) << "50 and the walls";
    EXPECT_TRUE(shared->findings().empty()) << shared->findings().front();
    for (const auto& of_peer : world.owned) EXPECT_EQ(of_peer.size(), 2u);
  }
}

TEST(ChaosWorld, IsAFunctionOfItsSeed) {
  EXPECT_EQ(draw_world(3, 5).text, draw_world(3, 5).text);
  EXPECT_NE(draw_world(3, 5).text, draw_world(4, 5).text);
}

}  // namespace peerd::chaos::world_text_test
