// Multicast between two network namespaces of the test's own, joined by a veth pair: the only way to have IPv6
// multicast on any computer (lo has none), and datagrams that really leave an interface.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <functional>
#include <system_error>
#include <thread>

#include "peerd/net/multicast_socket.hpp"
#include "tests/net/listener.hpp"

namespace peerd::net {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;
using testing_support::Listener;
using testing_support::own_port;
using testing_support::run_until;

// A network namespace belongs to a thread, a socket stays in the one where it was opened, and a namespace goes away
// with its last thread, descriptor and socket: nothing to clean up, not even after a crash.
class Namespace {
 public:
  // Moves the calling thread into a new one.
  Namespace() : fd_(unshare(CLONE_NEWNET) == 0 ? ::open("/proc/thread-self/ns/net", O_RDONLY) : -1) {
    if (fd_ < 0) problem_ = std::generic_category().message(errno);
  }
  Namespace(const Namespace&) = delete;
  Namespace& operator=(const Namespace&) = delete;
  ~Namespace() {
    if (fd_ >= 0) close(fd_);
  }
  void enter() const { ASSERT_EQ(setns(fd_, CLONE_NEWNET), 0) << std::generic_category().message(errno); }
  [[nodiscard]] const std::string& problem() const { return problem_; }
  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(fd_); }  // of whoever inherits it

 private:
  int fd_;
  std::string problem_;
};

bool shell(const std::string& command) { return std::system((command + " 2>/dev/null").c_str()) == 0; }

// left (interface va: 192.0.2.1, fe80::1) ---- right (interface vb: 192.0.2.2, fe80::2)
struct Wire {
  // Empty, or why there is none.
  std::string lay() {
    if (!left.problem().empty() || !right.problem().empty()) {
      return "no network namespaces here: " + left.problem() + right.problem();
    }
    left.enter();
    if (!shell("ip link add va type veth peer name vb && ip link set vb netns " + right.path())) {
      return "no veth pair here (package iproute2, kernel module veth)";
    }
    if (!address("va", "1")) return "the veth pair takes no IPv4 and IPv6 addresses";
    right.enter();
    if (!address("vb", "2")) return "the veth pair takes no IPv4 and IPv6 addresses";
    const bool right_up = comes_up("vb");
    left.enter();
    return right_up && comes_up("va") ? "" : "the veth pair does not come up within 5 s";
  }
  // The carrier is there some milliseconds after the second end is up.
  static bool comes_up(const std::string& name) {
    for (int tries = 0; tries < 500; ++tries) {
      const auto interfaces = list_interfaces();
      const auto is_up = [&](const Interface& i) { return i.name == name && i.running && i.has_ipv6; };
      if (interfaces && std::ranges::any_of(*interfaces, is_up)) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
  // nodad: an address is of no use while its uniqueness is being checked, for a second or two.
  static bool address(const std::string& name, const std::string& host) {
    return shell("ip link set lo up && ip link set " + name + " addrgenmode none && ip addr add 192.0.2." + host +
                 "/24 dev " + name + " && ip addr add fe80::" + host + "/64 dev " + name + " nodad && ip link set " +
                 name + " up");
  }

  Namespace left, right;
};

// Runs `body` on a thread of its own, with a wire; skips the test when there can be none.
void with_wire(const std::function<void(const Wire&)>& body) {
  std::string missing;
  std::thread([&] {
    try {
      Wire wire;
      missing = wire.lay();
      if (missing.empty()) body(wire);
    } catch (const std::exception& e) {  // GoogleTest catches on its own thread only
      ADD_FAILURE() << e.what();
    }
  }).join();
  if (!missing.empty()) GTEST_SKIP() << missing;
}

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
    Listener a(io, options(1, ""));  // one interface reaches others: no need to name it
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

TEST_P(OverAWire, AnInterfaceThatGoesDownDropsAndCounts) {
  with_wire([](const Wire& wire) {
    asio::io_context io;
    wire.left.enter();
    Listener a(io, options(3, "va"));
    ASSERT_TRUE(shell("ip link set va down"));
    const auto sent = a.socket->send(RegionId{1}, testing_support::bytes_of("x"));
    ASSERT_FALSE(sent);
    EXPECT_EQ(sent.error(), SendDrop::kUnreachable);
    EXPECT_EQ(a.socket->counters().out_unreachable, 1u);
    const auto again = MulticastSocket::open(io, options(3, "va"));
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
    Listener on_va(io, options(4, "va")), on_vc(io, options(4, "vc"));
    on_va.join(1), on_vc.join(1);
    sender.send(1, "over va");
    on_vc.send(1, "over vc");
    ASSERT_TRUE(run_until(io, [&] { return !on_va.heard.empty() && !on_vc.heard.empty(); }));
    EXPECT_THAT(on_va.heard, ElementsAre(Pair(1, "over va")));
    EXPECT_THAT(on_vc.heard, ElementsAre(Pair(1, "over vc")));
  });
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
        MulticastSocket::open(io, {.interface = "lo", .groups = {asio::ip::make_address("ff15::1:0:0"), own_port(5)}});
    ASSERT_FALSE(opened);
    EXPECT_EQ(opened.error().kind, NetError::Kind::kNoMulticast);
    EXPECT_THAT(opened.error().sentence, HasSubstr("lo carries no IPv6 multicast: use an IPv4 group"));
  });
}

}  // namespace
}  // namespace peerd::net
