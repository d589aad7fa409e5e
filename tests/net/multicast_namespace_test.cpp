// Multicast between two network namespaces, which a veth pair connects. Only this gives IPv6 multicast on any computer
// (lo has none), and datagrams that really leave an interface.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <memory>
#include <set>
#include <vector>

#include "peerd/net/transport/multicast_probe.hpp"
#include "peerd/net/transport/multicast_socket.hpp"
#include "tests/net/listener.hpp"
#include "tests/net/wire.hpp"

namespace peerd::net::multicast_namespace_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;
using testing_support::Listener;
using testing_support::Namespace;
using testing_support::own_port;
using testing_support::run_until;
using testing_support::shell;
using testing_support::Wire;
using testing_support::with_wire;

class OverAWire : public testing::TestWithParam<const char*> {
 protected:
  [[nodiscard]] static MulticastOptions options(unsigned slot, const char* interface) {
    return {.interface = interface, .groups = {asio::ip::make_address(GetParam()), own_port(slot)}};
  }
};
INSTANTIATE_TEST_SUITE_P(Families, OverAWire, testing::Values("239.192.0.0", "ff15::1:0:0", "ff12::1:0:0"),
                         [](const auto& c) -> std::string {
                           return *c.param == '2' ? "V4" : c.param[3] == '5' ? "V6SiteLocal" : "V6LinkLocal";
                         });

TEST_P(OverAWire, TwoSocketsOnOneInterfaceHearEachOther) {
  with_wire([](const Wire& wire) {
    asio::io_context io;
    wire.left.enter();
    Listener a(io, options(0, "va")), b(io, options(0, "va"));
    a.join(1), b.join(1), b.join(2);
    b.send(2, "not for a");
    b.send(1, "from b");
    a.send(1, "from a");
    ASSERT_TRUE(run_until(io, [&] { return a.heard.size() == 2 && b.heard.size() == 3; }));
    EXPECT_THAT(a.heard, ElementsAre(Pair(1, "from b"), Pair(1, "from a")));
    EXPECT_THAT(b.heard, ElementsAre(Pair(2, "not for a"), Pair(1, "from b"), Pair(1, "from a")));
    EXPECT_EQ(a.socket->counters().in_other_group, 0u);
    EXPECT_EQ(a.socket->counters().in_other_interface, 0u);
  });
}

TEST_P(OverAWire, DatagramsCrossIt) {
  with_wire([](const Wire& wire) {
    asio::io_context io;
    wire.left.enter();
    Listener a(io, options(1, ""));  // the only interface that reaches others need not be named
    wire.right.enter();
    Listener b(io, options(1, "vb"));
    EXPECT_EQ(a.socket->chosen_interface().interface.name, "va");
    a.join(1), b.join(1), b.join(2);
    a.send(2, "to two");
    a.send(1, "ping");
    b.send(1, "pong");
    ASSERT_TRUE(run_until(io, [&] { return a.heard.size() == 2 && b.heard.size() == 3; }));
    EXPECT_THAT(b.heard, testing::UnorderedElementsAre(Pair(2, "to two"), Pair(1, "ping"), Pair(1, "pong")));
    EXPECT_THAT(a.heard, testing::UnorderedElementsAre(Pair(1, "ping"), Pair(1, "pong")));
    for (const auto& sender : b.from) EXPECT_EQ(sender.port(), own_port(1));
    for (const Listener* l : {&a, &b}) {
      EXPECT_EQ(l->socket->counters().in_unstamped + l->socket->counters().in_stamp_refused, 0u);
    }
  });
}

// On an interface other than lo, the sender's copies take another way through the kernel, where the filter works, too.
TEST_P(OverAWire, ASocketWithoutOwnDatagramsReceivesTheOthers) {
  with_wire([](const Wire& wire) {
    asio::io_context io;
    wire.left.enter();
    const auto deaf_to_itself = [](MulticastOptions options) {
      options.receives_own_datagrams = false;
      return options;
    };
    Listener a(io, deaf_to_itself(options(6, "va"))), c(io, deaf_to_itself(options(6, "va")));
    wire.right.enter();
    Listener b(io, deaf_to_itself(options(6, "vb")));
    for (Listener* l : {&a, &b, &c}) l->join(1);
    a.send(1, "from a");
    b.send(1, "from b");
    c.send(1, "from c");
    ASSERT_TRUE(run_until(io, [&] { return a.heard.size() == 2 && b.heard.size() == 2 && c.heard.size() == 2; }));
    EXPECT_THAT(a.heard, testing::UnorderedElementsAre(Pair(1, "from b"), Pair(1, "from c")));
    EXPECT_THAT(b.heard, testing::UnorderedElementsAre(Pair(1, "from a"), Pair(1, "from c")));
    EXPECT_THAT(c.heard, testing::UnorderedElementsAre(Pair(1, "from a"), Pair(1, "from b")));
    for (const Listener* l : {&a, &b, &c}) EXPECT_EQ(l->socket->counters().in_queue_overflow, 0u);
  });
}

TEST_P(OverAWire, TheHopLimitIsAsAsked) {
  with_wire([](const Wire& wire) {
    asio::io_context io;
    wire.left.enter();
    MulticastOptions asked = options(2, "va");
    asked.ttl = 7;
    const Listener a(io, asked);
    const bool v4 = asked.groups.base.is_v4();
    int hops = -1;
    socklen_t size = sizeof hops;
    ASSERT_EQ(getsockopt(a.socket->native_handle(), v4 ? IPPROTO_IP : IPPROTO_IPV6,
                         v4 ? IP_MULTICAST_TTL : IPV6_MULTICAST_HOPS, &hops, &size),
              0);
    EXPECT_EQ(hops, 7);
  });
}

// The kernel regards an interface of the same name as another one, and memberships vanish with the old one.
void follow_what_is_made_anew(MulticastOptions left, MulticastOptions right) {
  with_wire([&](const Wire& wire) {
    asio::io_context io;
    wire.left.enter();
    left.receives_own_datagrams = false;
    Listener a(io, left);
    EXPECT_FALSE(a.socket->follow_interface());
    wire.right.enter();
    Listener b(io, right);
    a.join(1), a.join(2), b.join(1), b.join(4);
    wire.left.enter();
    ASSERT_TRUE(shell("ip link del va"));
    const auto gone = a.socket->follow_interface();
    ASSERT_TRUE(gone);
    EXPECT_FALSE(gone->is_back);
    EXPECT_THAT(gone->sentence, testing::HasSubstr("\"va\" is gone"));
    EXPECT_FALSE(a.socket->follow_interface()) << "is said once";
    EXPECT_TRUE(a.socket->leave(RegionId{2}));
    // The interface is back, and more groups are joined than one socket takes.
    for (std::uint32_t region = 3; region <= 50; ++region) EXPECT_TRUE(a.socket->join(RegionId{region})) << region;
    ASSERT_EQ(wire.connect(), "");
    for (const auto& [side, listener] : {std::pair(&wire.left, &a), {&wire.right, &b}}) {
      side->enter();
      const auto back = listener->socket->follow_interface();
      ASSERT_TRUE(back);
      EXPECT_TRUE(back->is_back);
      EXPECT_FALSE(listener->socket->follow_interface());
    }
    a.send(4, "to b");
    for (const std::uint32_t region : {1, 2, 3, 50}) b.send(region, "to a");
    ASSERT_TRUE(run_until(io, [&] { return a.heard.size() == 3 && b.heard.size() == 2; }));
    EXPECT_THAT(a.heard, testing::UnorderedElementsAre(Pair(1, "to a"), Pair(3, "to a"), Pair(50, "to a")));
    EXPECT_THAT(b.heard, testing::UnorderedElementsAre(Pair(4, "to b"), Pair(1, "to a")));
  });
}

TEST_P(OverAWire, AnInterfaceThatIsMadeAnewIsFollowed) { follow_what_is_made_anew(options(7, "va"), options(7, "vb")); }
TEST_P(OverAWire, AnInterfaceThatIsMadeAnewIsFollowedWhereRegionsShareGroups) {
  MulticastOptions left = options(7, "va"), right = options(7, "vb");
  left.groups.pool = right.groups.pool = 64;
  follow_what_is_made_anew(left, right);
}

TEST_P(OverAWire, AnInterfaceThatGoesDownDropsAndCounts) {
  with_wire([](const Wire& wire) {
    asio::io_context io;
    wire.left.enter();
    Listener a(io, options(3, "va"));
    ASSERT_TRUE(shell("ip link set va down"));
    a.send(1, "x");
    EXPECT_EQ(a.socket->counters().packets_out, 0u);
    EXPECT_EQ(a.socket->counters().out_unreachable, 1u);
    const auto again = MulticastSocket::open(io, testing_support::clock(), options(3, "va"));
    ASSERT_FALSE(again);
    EXPECT_EQ(again.error().kind, NetError::Kind::kNoMulticast);
    EXPECT_THAT(again.error().sentence, HasSubstr("interface \"va\" is down: bring it up"));
  });
}

TEST_P(OverAWire, AnotherInterfaceInTheSameGroupIsNotHeard) {
  with_wire([](const Wire& wire) {
    asio::io_context io;
    wire.right.enter();
    Listener sender(io, options(4, "vb"));
    wire.left.enter();
    ASSERT_TRUE(shell("ip link add vc type veth peer name vd && ip link set vd up") && Wire::address("vc", "9"));
    ASSERT_TRUE(Wire::comes_up("vc"));
    Listener on_va(io, options(4, "va")), on_vc(io, options(4, "vc"));
    on_va.join(1), on_vc.join(1);
    sender.send(1, "over va");
    on_vc.send(1, "over vc");
    ASSERT_TRUE(run_until(io, [&] { return !on_va.heard.empty() && !on_vc.heard.empty(); }));
    EXPECT_THAT(on_va.heard, ElementsAre(Pair(1, "over va")));
    EXPECT_THAT(on_vc.heard, ElementsAre(Pair(1, "over vc")));
  });
}

// ---- limits that change while a peer runs ----

void write_limit(const char* path, int value) { ASSERT_TRUE(shell("echo " + std::to_string(value) + " > " + path)); }
constexpr const char* kIpv4Limit = "/proc/sys/net/ipv4/igmp_max_memberships";  // each namespace has its own
constexpr const char* kIpv6Limit = "/proc/sys/net/core/optmem_max";            // since Linux 6.8

TEST(Memberships, ALimitThatIsLoweredMeanwhileTakesMoreSockets) {
  with_wire([](const Wire& wire) {
    wire.left.enter();
    asio::io_context io;
    Listener a(io, {.interface = "va", .groups = {asio::ip::make_address("239.192.0.0"), own_port(8)}});
    write_limit(kIpv4Limit, 4);
    for (std::uint32_t region = 0; region < 10; ++region) a.join(region);
    EXPECT_EQ(a.socket->socket_count(), 3u);
    for (std::uint32_t region = 0; region < 10; ++region) a.send(region, "x");
    EXPECT_TRUE(run_until(io, [&] { return a.heard.size() == 10; }));
  });
}

TEST(Memberships, ALimitOfNoneIsAnErrorThatSaysSo) {
  with_wire([](const Wire& wire) {
    wire.left.enter();
    write_limit(kIpv4Limit, 0);
    asio::io_context io;
    Listener a(io, {.interface = "va", .groups = {asio::ip::make_address("239.192.0.0"), own_port(8)}});
    for (int tries = 0; tries < 3; ++tries) {
      const auto refused = a.socket->join(RegionId{1});
      ASSERT_FALSE(refused);
      EXPECT_EQ(refused.error().kind, NetError::Kind::kLimit);
      EXPECT_THAT(refused.error().sentence, HasSubstr("net.ipv4.igmp_max_memberships"));
    }
    EXPECT_EQ(a.socket->socket_count(), 1u) << "none is left over";
  });
}

TEST(Memberships, Ipv6CountsMemoryAndTakesMoreSocketsToo) {
  bool own_limit = true;
  with_wire([&](const Wire& wire) {
    wire.left.enter();
    own_limit = shell("echo 4096 > " + std::string(kIpv6Limit));
    if (!own_limit) return;
    asio::io_context io;
    Listener a(io, {.interface = "va", .groups = {asio::ip::make_address("ff15::1:0:0"), own_port(8)}});
    constexpr std::uint32_t kMany = 200;
    for (std::uint32_t region = 0; region < kMany; ++region) a.join(region);
    EXPECT_GT(a.socket->socket_count(), 1u);
    for (std::uint32_t region = 0; region < kMany; ++region) a.send(region, "x");
    EXPECT_TRUE(run_until(io, [&] { return a.heard.size() == kMany; }));
    EXPECT_EQ(a.socket->counters().packets_in, kMany);
  });
  if (!own_limit) GTEST_SKIP() << "net.core.optmem_max is not this namespace's own (Linux 6.8)";
}

// A computer with no network at all is enough for IPv4.
TEST(OnlyLo, CarriesIpv4FromItsOwnAddress) {
  with_wire([](const Wire&) {
    const Namespace lonely;
    ASSERT_EQ(lonely.problem(), "");
    ASSERT_TRUE(shell("ip link set lo up"));
    asio::io_context io;
    const MulticastOptions options{.groups = {asio::ip::make_address("239.192.0.0"), own_port(6)}};
    Listener a(io, options), b(io, options);
    EXPECT_EQ(a.socket->chosen_interface().interface.name, "lo");
    b.join(1);
    a.send(1, "x");
    ASSERT_TRUE(run_until(io, [&] { return !b.heard.empty(); }));
    EXPECT_EQ(b.from.front().address(), asio::ip::address_v4::loopback());
  });
}

TEST(Ipv6Port, MayBeTakenInIpv4) {
  with_wire([](const Wire& wire) {
    asio::io_context io;
    wire.left.enter();
    const asio::ip::udp::socket other(io, asio::ip::udp::endpoint(asio::ip::udp::v4(), own_port(7)));
    const Listener a(io, {.interface = "va", .groups = {asio::ip::make_address("ff15::1:0:0"), own_port(7)}});
  });
}

TEST(Ipv6OverLo, IsRefusedWithAWayOut) {
  with_wire([](const Wire& wire) {
    asio::io_context io;
    wire.left.enter();
    const auto opened =
        MulticastSocket::open(io, testing_support::clock(),
                              {.interface = "lo", .groups = {asio::ip::make_address("ff15::1:0:0"), own_port(5)}});
    ASSERT_FALSE(opened);
    EXPECT_EQ(opened.error().kind, NetError::Kind::kNoMulticast);
    EXPECT_THAT(opened.error().sentence, HasSubstr("lo carries no IPv6 multicast: use an IPv4 group"));
  });
}

// Each peer filters out datagrams from its sender's port, so it would never hear a peer with the same sender's port.
// Where nearly all ports are taken, the system gives one port to two sockets that may share it.
TEST(OverLo, NoTwoSendersHaveOnePort) {
  with_wire([](const Wire& wire) {
    asio::io_context io;
    wire.left.enter();
    ASSERT_TRUE(shell("ip link set lo up && echo 40000 40013 > /proc/sys/net/ipv4/ip_local_port_range"));
    const MulticastOptions options{.interface = "lo",
                                   .groups = {asio::ip::make_address("239.192.0.0"), own_port(2)},
                                   .receives_own_datagrams = false};
    std::vector<std::unique_ptr<MulticastSocket>> open;
    std::set<std::uint16_t> ports;
    for (int i = 0; i < 12; ++i) {
      auto opened = MulticastSocket::open(io, testing_support::clock(), options);
      ASSERT_TRUE(opened) << opened.error().sentence;
      sockaddr_in bound{};
      socklen_t size = sizeof bound;
      ASSERT_EQ(getsockname((*opened)->native_handle(), reinterpret_cast<sockaddr*>(&bound), &size), 0);
      EXPECT_TRUE(ports.insert(ntohs(bound.sin_port)).second);
      open.push_back(*std::move(opened));
    }
    EXPECT_GE(*ports.begin(), 40000);
    EXPECT_LE(*ports.rbegin(), 40013);
  });
}

// A firewall that lets the peers' port through, as docs/how-to/firewall.md says, keeps the first probe back.
TEST(OverAWireWithAFirewall, TheProbeFindsThatThePeersPortIsOpen) {
  with_wire([](const Wire& wire) {
    wire.left.enter();
    const std::string rules =
        "nft 'table inet f { chain in { type filter hook input priority 0; policy drop; udp dport " +
        std::to_string(own_port(3)) + " accept; }; }'";
    if (!shell(rules)) GTEST_SKIP() << "there is no nft here";
    MulticastOptions options{.interface = "va", .groups = {asio::ip::make_address("239.192.4.0"), own_port(3)}};
    asio::io_context io;
    Listener peer(io, options);
    peer.join(0);
    const auto probe = probe_multicast(testing_support::clock(), options);
    EXPECT_TRUE(probe) << probe.error().sentence;
    peer.send(0, "marker");
    ASSERT_TRUE(run_until(io, [&] { return !peer.heard.empty(); }));
    EXPECT_EQ(peer.heard.front().second, "marker");  // no peer receives the probe
    options.groups.port = own_port(4);
    EXPECT_FALSE(probe_multicast(testing_support::clock(), options));
  });
}

}  // namespace peerd::net::multicast_namespace_test
