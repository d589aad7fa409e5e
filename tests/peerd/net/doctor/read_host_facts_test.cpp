#include <gtest/gtest.h>

#include <boost/asio/ip/tcp.hpp>

#include "peerd/net/doctor/host_facts.hpp"
#include "tests/must.hpp"
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
    const auto facts = must(read_host_facts(net::testing_support::clock(), {peer_at("192.0.2.2")}, {}));
    EXPECT_EQ(facts.memberships_max, 7u);
    EXPECT_EQ(facts.links.size(), 2u);
    EXPECT_EQ(facts.routes.at(0).peer, "192.0.2.2");
  });
}

TEST(ReadHostFacts, PortsOfOtherProgramsAreTaken) {
  using boost::asio::ip::tcp;
  using boost::asio::ip::udp;
  boost::asio::io_context io(1);
  udp::socket greedy(io, udp::endpoint(udp::v4(), 0)), sharing(io, udp::v4());
  sharing.set_option(boost::asio::socket_base::reuse_address(true));
  sharing.bind({udp::v4(), 0});
  const tcp::acceptor listening(io, tcp::endpoint(tcp::v4(), 0));
  const std::uint16_t held = greedy.local_endpoint().port(), listened = listening.local_endpoint().port();
  EXPECT_EQ(taken_of({.discovery = held, .snapshot = listened}).discovery, held);
  EXPECT_EQ(taken_of({.discovery = held, .snapshot = listened}).snapshot, listened);
  EXPECT_EQ(taken_of({.discovery = sharing.local_endpoint().port()}).discovery, 0);
  greedy.close();
  EXPECT_EQ(taken_of({.discovery = held}).discovery, 0);
  EXPECT_EQ(taken_of({}).snapshot, 0);
}

}  // namespace peerd::doctor::read_host_facts_test
