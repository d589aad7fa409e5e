#include <gtest/gtest.h>

#include <algorithm>

#include "peerd/net/doctor/host_facts.hpp"
#include "tests/net/wire.hpp"

namespace peerd::doctor::read_links_test {

using net::testing_support::shell;
using net::testing_support::Wire;
using net::testing_support::with_wire;

Link link_named(const std::string& name) {
  const auto links = read_links();
  if (!links) {
    ADD_FAILURE() << links.error().sentence;
    return {};
  }
  const auto found = std::ranges::find(*links, name, &Link::name);
  if (found != links->end()) return *found;
  ADD_FAILURE() << "no link " << name;
  return {};
}

TEST(ReadLinks, TellsKindsStatesAndLengths) {
  with_wire([](const Wire& wire) {
    wire.left.enter();
    ASSERT_TRUE(shell("ip link set va mtu 1300"));
    const Link va = link_named("va"), lo = link_named("lo");
    EXPECT_EQ(va.kind, "veth");
    EXPECT_EQ(va.mtu_bytes, 1300u);
    EXPECT_TRUE(va.up && va.has_carrier && va.multicast && va.other_end_elsewhere && !va.loopback && !va.wireless);
    EXPECT_TRUE(lo.loopback && lo.up && !lo.multicast);
    wire.right.enter();
    ASSERT_TRUE(shell("ip link set vb down"));
    wire.left.enter();
    EXPECT_FALSE(link_named("va").has_carrier);
    ASSERT_TRUE(shell("ip link set va down"));
    EXPECT_FALSE(link_named("va").up);
  });
}

TEST(ReadLinks, KnowsABridgeItsPortsAndWhetherItAsks) {
  with_wire([](const Wire& wire) {
    wire.left.enter();
    ASSERT_TRUE(shell("ip link add vc type bridge mcast_snooping 1 mcast_querier 0 && ip link set va master vc"));
    const Link bridge = link_named("vc");
    EXPECT_EQ(bridge.kind, "bridge");
    EXPECT_TRUE(bridge.snooping && !bridge.querier && !bridge.querier_elsewhere);
    EXPECT_EQ(link_named("va").bridge_index, bridge.index);
    ASSERT_TRUE(shell("ip link set vc type bridge mcast_snooping 0 mcast_querier 1"));
    EXPECT_TRUE(!link_named("vc").snooping && link_named("vc").querier);
  });
}

}  // namespace peerd::doctor::read_links_test
