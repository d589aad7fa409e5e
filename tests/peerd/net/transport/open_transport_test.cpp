#include "peerd/net/transport/open_transport.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"
#include "tests/net/listener.hpp"
#include "tests/net/wire.hpp"

namespace peerd::net::open_transport_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::clock;
using testing_support::own_port;
using testing_support::shell;
using testing_support::Wire;
using testing_support::with_wire;

TransportOptions over(const char* interface, MulticastUse use, std::vector<std::string> peers = {},
                      const char* group = "239.192.4.0") {
  TransportOptions options;
  options.multicast.interface = interface;
  options.multicast.groups = {asio::ip::make_address(group), own_port(0)};
  options.use = use;
  options.peers = std::move(peers);
  options.key = {1, 0};
  return options;
}

struct OpenTransport : testing::Test {
  // "multicast", or the reason against it.
  std::string kind_of(const TransportOptions& options) {
    const auto opened = open_transport(io, clock(), options);
    if (!opened) return "error: " + opened.error().sentence;
    const bool unicast = dynamic_cast<const UnicastFanOut*>(opened->transport.get()) != nullptr;
    EXPECT_EQ(unicast, !opened->why_unicast.empty());
    return unicast ? "unicast: " + opened->why_unicast : "multicast";
  }
  asio::io_context io;
};

TEST_F(OpenTransport, IsMulticastWhereThatWorks) {
  EXPECT_EQ(kind_of(over("lo", MulticastUse::kAuto)), "multicast");
  EXPECT_EQ(kind_of(over("lo", MulticastUse::kAuto, {"127.0.0.1:4000"})), "multicast");
  EXPECT_EQ(kind_of(over("lo", MulticastUse::kAlways)), "multicast");
}

TEST_F(OpenTransport, IsUnicastWhereItIsToldTo) {
  EXPECT_EQ(kind_of(over("lo", MulticastUse::kNever)), "unicast: transport.multicast says so");
}

// lo does no multicast over IPv6.
TEST_F(OpenTransport, IsUnicastWhereThereIsNoMulticastAndThereArePeers) {
  const char* const ipv6 = "ff15::1:0:0";
  EXPECT_THAT(kind_of(over("lo", MulticastUse::kAuto, {"[::1]:4000"}, ipv6)),
              HasSubstr("unicast: cannot multicast to ff15::1:0:0 over \"lo\""));
  EXPECT_THAT(kind_of(over("lo", MulticastUse::kAuto, {}, ipv6)),
              HasSubstr("list other peers' addresses in transport.peers"));
  EXPECT_THAT(kind_of(over("lo", MulticastUse::kAlways, {"[::1]:4000"}, ipv6)), HasSubstr("error: cannot multicast"));
}

TEST_F(OpenTransport, AnErrorThatUnicastWouldNotMendIsOne) {
  EXPECT_THAT(kind_of(over("nosuch9", MulticastUse::kAuto, {"127.0.0.1:4000"})),
              HasSubstr("error: no interface named \"nosuch9\""));
}

TEST_F(OpenTransport, AnInterfaceWithoutMulticastIsFoundOut) {
  with_wire([&](const Wire& wire) {
    wire.left.enter();
    ASSERT_TRUE(shell("ip link set va multicast off"));
    EXPECT_THAT(kind_of(over("va", MulticastUse::kAuto, {"192.0.2.2:4000"})),
                HasSubstr("unicast: interface \"va\" does not do multicast"));
    ASSERT_TRUE(shell("ip link set va multicast on"));
    EXPECT_EQ(kind_of(over("va", MulticastUse::kAuto, {"192.0.2.2:4000"})), "multicast");
  });
}

// lo works for this computer only, and there are peers to reach.
TEST_F(OpenTransport, LoIsNoAnswerForWhoHasPeersToReach) {
  with_wire([&](const Wire& wire) {
    wire.left.enter();
    ASSERT_TRUE(shell("ip link set va multicast off"));
    EXPECT_EQ(kind_of(over("", MulticastUse::kAuto)), "multicast");
    EXPECT_THAT(kind_of(over("", MulticastUse::kAuto, {"192.0.2.2:4000"})),
                HasSubstr("unicast: lo, as no other can multicast"));
    EXPECT_EQ(kind_of(over("lo", MulticastUse::kAuto, {"192.0.2.2:4000"})), "multicast") << "as configured";
  });
}

TEST_F(OpenTransport, AJoinThatIsRefusedIsFoundOut) {
  with_wire([&](const Wire& wire) {
    wire.left.enter();
    ASSERT_TRUE(shell("echo 0 > /proc/sys/net/ipv4/igmp_max_memberships"));
    EXPECT_THAT(kind_of(over("va", MulticastUse::kAuto, {"192.0.2.2:4000"})),
                HasSubstr("unicast: cannot join the multicast group of region 0"));
    EXPECT_THAT(kind_of(over("va", MulticastUse::kAuto)),
                HasSubstr("error: cannot join the multicast group of region 0"));
  });
}

// Everything opens well but no datagram arrives, for traffic control redirects what comes over va.
TEST_F(OpenTransport, MulticastThatIsSwallowedIsFoundOut) {
  bool led_away = true;
  with_wire([&](const Wire& wire) {
    wire.left.enter();
    led_away = shell(
        "ip link add vc type veth peer name vd && ip link set vc up && ip link set vd up && "
        "tc qdisc add dev va clsact && tc filter add dev va ingress protocol ip prio 1 u32 "
        "match u32 0 0 action mirred egress redirect dev vc");
    if (!led_away) return;
    const HostTime before = clock().now();
    EXPECT_THAT(kind_of(over("va", MulticastUse::kAuto, {"192.0.2.2:4000"})),
                HasSubstr("unicast: multicast sent over \"va\" does not come back to this computer"));
    EXPECT_GE(clock().now() - before, std::chrono::milliseconds(300)) << "it has waited for it";
  });
  if (!led_away) GTEST_SKIP() << "no traffic control here (package iproute2, kernel modules cls_u32 and act_mirred)";
}

// ---- configured addresses ----

TEST(ResolvePeers, ReadsAddressesOfTheFamily) {
  using asio::ip::make_address;
  const auto v4 = must(resolve_peers({"192.0.2.1:4000", "127.0.0.1:1"}, IpFamily::kV4));
  EXPECT_THAT(v4, ElementsAre(asio::ip::udp::endpoint(make_address("192.0.2.1"), 4000),
                              asio::ip::udp::endpoint(make_address("127.0.0.1"), 1)));
  const auto v6 = must(resolve_peers({"[2001:db8::1]:65535"}, IpFamily::kV6));
  EXPECT_THAT(v6, ElementsAre(asio::ip::udp::endpoint(make_address("2001:db8::1"), 65535)));
  EXPECT_FALSE(resolve_peers({"[2001:db8::1]:4000"}, IpFamily::kV4));
  EXPECT_FALSE(resolve_peers({"192.0.2.1:4000"}, IpFamily::kV6));
}

class BadPeer : public testing::TestWithParam<const char*> {};
TEST_P(BadPeer, IsNamed) {
  EXPECT_THAT(error_of(resolve_peers({"192.0.2.1:4000", GetParam()}, IpFamily::kV4)),
              IsError(NetError::Kind::kBadSetting, HasSubstr("\"" + std::string(GetParam()) + "\" is no HOST:PORT")));
}
INSTANTIATE_TEST_SUITE_P(Table, BadPeer,
                         testing::Values("", "192.0.2.1", ":4000", "192.0.2.1:", "192.0.2.1:0", "192.0.2.1:65536",
                                         "192.0.2.1:4x", "192.0.2.1: 4000", "2001:db8::1:4000", "[]:4000",
                                         "[192.0.2.1:4000", "192.0.2.1]:4000"));

}  // namespace peerd::net::open_transport_test
