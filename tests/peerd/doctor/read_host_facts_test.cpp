#include <gtest/gtest.h>

#include "peerd/doctor/host_facts.hpp"
#include "tests/net/listener.hpp"
#include "tests/net/wire.hpp"

namespace peerd::doctor::read_host_facts_test {

using net::testing_support::shell;
using net::testing_support::Wire;
using net::testing_support::with_wire;

NamedPeer peer_at(const std::string& address) { return {address, {boost::asio::ip::make_address(address), 47474}}; }

TEST(ReadHostFacts, RoutesGoOverInterfacesHereOrNowhere) {
  with_wire([](const Wire& wire) {
    wire.left.enter();
    const Route there = route_to(peer_at("192.0.2.2"));
    EXPECT_EQ(there.way, Route::Way::kOutwards);
    EXPECT_EQ(there.interface, "va");
    EXPECT_EQ(route_to(peer_at("192.0.2.1")).way, Route::Way::kThisComputer);
    EXPECT_EQ(route_to(peer_at("127.0.0.1")).way, Route::Way::kThisComputer);
    EXPECT_EQ(route_to(peer_at("::1")).way, Route::Way::kThisComputer);
    EXPECT_EQ(route_to(peer_at("198.51.100.1")).way, Route::Way::kNone);
  });
}

TEST(ReadHostFacts, LimitsAreThoseOfThisNamespace) {
  with_wire([](const Wire& wire) {
    wire.left.enter();
    ASSERT_TRUE(shell("echo 7 > /proc/sys/net/ipv4/igmp_max_memberships"));
    const auto facts = read_host_facts(net::testing_support::clock(), {peer_at("192.0.2.2")});
    ASSERT_TRUE(facts) << facts.error().sentence;
    EXPECT_EQ(facts->memberships_max, 7u);
    EXPECT_EQ(facts->links.size(), 2u);
    EXPECT_EQ(facts->routes.at(0).peer, "192.0.2.2");
  });
}

}  // namespace peerd::doctor::read_host_facts_test
