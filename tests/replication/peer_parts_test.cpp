#include "replication/peer_parts.hpp"

#include <gtest/gtest.h>

#include "tests/replication/lan.hpp"
#include "tests/replication/parts.hpp"

namespace peerd::replication::peer_parts_test {

using namespace test;

TEST(PeerParts, OwnsWhatItsConfigurationSays) {
  const World world(field(3));
  const PeerParts p(config(4, {{world["O2"]}, {world["O0"], true}}), *world.model);
  EXPECT_EQ(p.owners.of(world["O0"]), PeerId{4});
  EXPECT_EQ(p.owners.of(world["O1"]), kNobody);
  EXPECT_EQ(p.owners.of(world["O2"]), PeerId{4});
  EXPECT_EQ(p.ticks.hz(), p.config.tick_hz);
  EXPECT_FALSE(p.replica.begun());
}

TEST(PeerParts, CountsDropsInAllAndByMember) {
  const World world(field(1));
  PeerParts p(config(4), *world.model);
  add_member(p.members, 7);
  p.drop(PeerId{7}, "reason");
  p.drop(PeerId{8}, "reason");
  EXPECT_EQ(p.counters.drops["reason"], 2u);
  EXPECT_EQ(p.members.find(PeerId{7})->drops["reason"], 1u);
  EXPECT_FALSE(p.members.contains(PeerId{8}));
}

}  // namespace peerd::replication::peer_parts_test
