#include "peerd/net/transport/multicast_socket.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include <algorithm>
#include <boost/asio/ip/multicast.hpp>
#include <thread>

#include "tests/must.hpp"
#include "tests/net/listener.hpp"

namespace peerd::net::multicast_socket_test {

using asio::ip::udp;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
using testing_support::bytes_of;
using testing_support::Listener;
using testing_support::own_port;
using testing_support::run_until;

// Real IPv4 multicast over lo.
class MulticastSocketTest : public testing::Test {
 protected:
  MulticastOptions options(unsigned slot, const char* base = "239.192.0.0") const {
    return {.interface = "lo", .groups = {asio::ip::make_address(base), own_port(slot)}};
  }
  NetError error_of(const MulticastOptions& refused) {
    const auto opened = MulticastSocket::open(io, testing_support::clock(), refused);
    EXPECT_FALSE(opened);
    return opened ? NetError{} : opened.error();
  }

  asio::io_context io;
};

TEST_F(MulticastSocketTest, TwoSocketsOnOnePortHearEachOtherAndThemselves) {
  Listener a(io, options(0)), b(io, options(0));
  a.join(1), b.join(1);
  a.send(1, "from a");
  b.send(1, "from b");
  ASSERT_TRUE(run_until(io, [&] { return a.heard.size() == 2 && b.heard.size() == 2; }));
  EXPECT_THAT(a.heard, ElementsAre(Pair(1, "from a"), Pair(1, "from b")));
  EXPECT_EQ(a.heard, b.heard);
  EXPECT_EQ(a.from.at(1).address(), asio::ip::make_address("127.0.0.1"));
  EXPECT_EQ(a.from.at(1).port(), own_port(0));
  EXPECT_EQ(a.socket->counters().packets_in, 2u);
  EXPECT_EQ(a.socket->counters().bytes_in, 12u);
  EXPECT_EQ(a.socket->counters().packets_out, 1u);
  EXPECT_EQ(a.socket->counters().bytes_out, 6u);
}

TEST_F(MulticastSocketTest, TheRegionIsTheOneSentTo) {
  Listener a(io, options(1)), b(io, options(1));
  for (const std::uint32_t region : {0u, 1u, 7u, 300u}) b.join(region);
  for (const std::uint32_t region : {300u, 0u, 7u, 1u}) a.send(region, std::to_string(region));
  ASSERT_TRUE(run_until(io, [&] { return b.heard.size() == 4; }));
  EXPECT_THAT(b.heard, ElementsAre(Pair(300, "300"), Pair(0, "0"), Pair(7, "7"), Pair(1, "1")));
  EXPECT_THAT(a.heard, IsEmpty());  // a sender need not join
}

// Without IP_MULTICAST_ALL=0 the kernel delivers every group that anyone on this computer joined.
TEST_F(MulticastSocketTest, ARegionThatOnlyAnotherSocketJoinedDoesNotReachThisOne) {
  Listener one(io, options(2)), two(io, options(2));
  one.join(1);
  two.join(2), two.join(1);
  two.send(2, "not for one");
  two.send(1, "marker");
  ASSERT_TRUE(run_until(io, [&] { return !one.heard.empty() && two.heard.size() == 2; }));
  EXPECT_THAT(one.heard, ElementsAre(Pair(1, "marker")));
  EXPECT_EQ(one.socket->counters().in_other_group, 0u) << "the kernel delivered it and it was dropped only here";
}

TEST_F(MulticastSocketTest, LeavingStopsARegionAndJoiningAgainResumesIt) {
  Listener a(io, options(3)), b(io, options(3));
  b.join(1), b.join(2);
  a.join(1);  // the computer stays in the group
  a.send(1, "before");
  ASSERT_TRUE(run_until(io, [&] { return b.heard.size() == 1; }));
  b.leave(1);
  a.send(1, "while away");
  a.send(2, "marker");
  ASSERT_TRUE(run_until(io, [&] { return b.heard.size() == 2; }));
  EXPECT_THAT(b.heard, ElementsAre(Pair(1, "before"), Pair(2, "marker")));
  EXPECT_EQ(b.socket->counters().in_other_group, 0u);
  b.join(1);
  a.send(1, "after");
  ASSERT_TRUE(run_until(io, [&] { return b.heard.size() == 3; }));
  EXPECT_THAT(b.heard.back(), Pair(1, "after"));
}

TEST_F(MulticastSocketTest, WhatTheKernelHadQueuedBeforeLeavingIsDroppedAndCounted) {
  Listener a(io, options(4)), b(io, options(4));
  b.join(1), b.join(2);
  a.send(1, "queued");
  a.send(2, "marker");
  b.leave(1);
  ASSERT_TRUE(run_until(io, [&] { return !b.heard.empty(); }));
  EXPECT_THAT(b.heard, ElementsAre(Pair(2, "marker")));
  EXPECT_EQ(b.socket->counters().in_other_group, 1u);
}

TEST_F(MulticastSocketTest, JoiningAndLeavingMayBeRepeated) {
  Listener a(io, options(5));
  a.leave(1);
  a.join(1), a.join(1);
  EXPECT_EQ(a.socket->joined_count(), 1u);
  a.leave(1), a.leave(1);
  EXPECT_EQ(a.socket->joined_count(), 0u);
}

// Datagrams that the filter drops are not lost, although the kernel counts both together.
TEST_F(MulticastSocketTest, ASocketWithoutOwnDatagramsCountsOnlyOthers) {
  constexpr std::size_t kFlood = 200, kOwn = 50;
  MulticastOptions deaf_to_itself = options(15);
  deaf_to_itself.receives_own_datagrams = false;
  deaf_to_itself.receive_buffer_bytes = 16 * 1024;
  Listener a(io, options(15)), b(io, deaf_to_itself);
  a.join(1), b.join(1);
  for (std::size_t i = 0; i < kOwn; ++i) b.send(1, "from b");
  a.send(1, "from a");
  ASSERT_TRUE(run_until(io, [&] { return b.heard.size() == 1 && a.heard.size() == kOwn + 1; }));
  EXPECT_EQ(b.socket->counters().in_queue_overflow, 0u);
  EXPECT_EQ(b.socket->counters().calls_in, 1u) << "nobody was woken for what it said itself";

  b.heard.clear();
  const std::string kilobyte(1000, 'x');
  for (std::size_t i = 0; i < kFlood; ++i) {
    a.send(1, kilobyte);
    if (i % 4 == 0) b.send(1, "from b");
  }
  ASSERT_TRUE(run_until(io, [&] { return !b.heard.empty(); }));
  const std::size_t before_marker = b.heard.size();
  a.send(1, "marker");
  ASSERT_TRUE(run_until(io, [&] { return b.heard.back().second == "marker"; }));
  EXPECT_LT(before_marker, kFlood);
  EXPECT_EQ(b.socket->counters().in_queue_overflow, kFlood - before_marker);
}

TEST_F(MulticastSocketTest, TheHandlerMayJoinLeaveAndSend) {
  Listener a(io, options(8));
  Listener::Heard heard;
  auto b = must(MulticastSocket::open(io, testing_support::clock(), options(8)));
  MulticastSocket& echo = *b;
  ASSERT_TRUE(echo.join(RegionId{1}));
  echo.on_receive([&](const Arrival& arrival) {
    EXPECT_TRUE(echo.leave(arrival.region));
    EXPECT_TRUE(echo.join(RegionId{2}));
    echo.send(RegionId{3}, arrival.datagram);
    echo.flush();
  });
  a.join(3);
  a.send(1, "ping");
  ASSERT_TRUE(run_until(io, [&] { return !a.heard.empty(); }));
  EXPECT_THAT(a.heard, ElementsAre(Pair(3, "ping")));
  EXPECT_EQ(echo.joined_count(), 1u);
}

// Other programs may send hostile datagrams to our port.
TEST_F(MulticastSocketTest, StrangeDatagramsAreCountedAndDropped) {
  const MulticastOptions ours = options(10, "239.192.1.0");
  Listener b(io, ours);
  b.join(0);
  udp::socket outsider(io, udp::v4());
  outsider.set_option(asio::ip::multicast::outbound_interface(asio::ip::address_v4::loopback()));
  const auto send_to = [&](const char* address, std::size_t size) {
    const std::string text(size, 'x');
    outsider.send_to(asio::buffer(text), {asio::ip::make_address(address), ours.groups.port});
  };
  send_to("127.0.0.1", 10);                       // to the port, to no group
  send_to("239.192.1.0", kMaxDatagramBytes + 1);  // one byte too many
  send_to("239.192.1.0", 60'000);
  send_to("239.192.1.0", 0);                  // empty is a datagram too
  send_to("239.192.1.0", kMaxDatagramBytes);  // the longest
  ASSERT_TRUE(run_until(io, [&] { return b.heard.size() == 2; }));
  EXPECT_THAT(b.heard, ElementsAre(Pair(0, ""), Pair(0, std::string(kMaxDatagramBytes, 'x'))));
  EXPECT_EQ(b.socket->counters().in_truncated, 2u);
  EXPECT_EQ(b.socket->counters().in_other_group, 1u);
  EXPECT_EQ(b.socket->counters().packets_in, 2u);
}

TEST_F(MulticastSocketTest, WhatCannotBeSentIsACountedDrop) {
  Listener a(io, options(11, "239.255.255.255"));
  a.send(0, std::string(kMaxDatagramBytes + 1, 'x'));
  a.send(1, "x");
  EXPECT_EQ(a.socket->counters().out_too_large, 1u);
  EXPECT_EQ(a.socket->counters().out_no_group, 1u);
  EXPECT_EQ(a.socket->counters().packets_out, 0u);
  EXPECT_EQ(a.socket->join(RegionId{1}).error().kind, NetError::Kind::kLimit);
}

TEST_F(MulticastSocketTest, SocketOptionsAreAsAsked) {
  for (const int ttl : {0, 1, 16, 255}) {
    MulticastOptions asked = options(12);
    asked.ttl = ttl;
    asked.dscp = 46;  // expedited forwarding
    const Listener a(io, asked);
    const auto option = [&](int level, int name) {
      int value = -1;
      socklen_t size = sizeof value;
      EXPECT_EQ(getsockopt(a.socket->native_handle(), level, name, &value, &size), 0);
      return value;
    };
    EXPECT_EQ(option(IPPROTO_IP, IP_MULTICAST_TTL), ttl);
    EXPECT_EQ(option(IPPROTO_IP, IP_TOS), 46 << 2);
    EXPECT_EQ(option(IPPROTO_IP, IP_MULTICAST_LOOP), 1);
    EXPECT_EQ(option(IPPROTO_IP, IP_MULTICAST_ALL), 0);
    EXPECT_EQ(option(SOL_SOCKET, SO_REUSEADDR), 1);
    EXPECT_GT(a.socket->receive_buffer_bytes(), 0);
    EXPECT_EQ(a.socket->chosen_interface().interface.name, "lo");
  }
}

// ---- more groups than a socket may join ----

TEST_F(MulticastSocketTest, AsManyGroupsAsWanted) {
  const auto limit = memberships_limit(IpFamily::kV4);
  if (!limit || *limit == 0 || *limit > 500) GTEST_SKIP() << "igmp_max_memberships is " << limit.value_or(0);
  const auto count = static_cast<std::uint32_t>(3 * *limit + 1);
  Listener a(io, options(13)), b(io, options(13));
  for (std::uint32_t region = 0; region < count; ++region) b.join(region);
  EXPECT_EQ(b.socket->socket_count(), 4u);
  EXPECT_EQ(b.socket->joined_count(), count);
  for (std::uint32_t region = 0; region < count; ++region) a.send(region, std::to_string(region));
  ASSERT_TRUE(run_until(io, [&] { return b.heard.size() == count; }));
  b.socket->receive_pending();
  std::ranges::sort(b.heard, {}, &Listener::Heard::value_type::first);
  for (std::uint32_t region = 0; region < count; ++region) {
    EXPECT_THAT(b.heard[region], Pair(region, std::to_string(region))) << "each once, though four sockets share a port";
  }
  EXPECT_EQ(b.socket->counters().in_other_group, 0u);
}

TEST_F(MulticastSocketTest, WhatLeavesMakesRoom) {
  const auto limit = memberships_limit(IpFamily::kV4);
  if (!limit || *limit < 2 || *limit > 500) GTEST_SKIP() << "igmp_max_memberships is " << limit.value_or(0);
  Listener a(io, options(13)), b(io, options(13));
  const auto count = static_cast<std::uint32_t>(*limit);
  for (std::uint32_t region = 0; region < count; ++region) b.join(region);
  for (std::uint32_t region = 0; region < 200; ++region) {
    b.leave(region);
    b.join(region + count);
  }
  EXPECT_EQ(b.socket->socket_count(), 1u);
  a.send(199, "left");
  a.send(200, "marker");
  ASSERT_TRUE(run_until(io, [&] { return !b.heard.empty(); }));
  EXPECT_THAT(b.heard, ElementsAre(Pair(200, "marker")));
}

// The kernel's limit is for each socket; a handler may need another socket in the middle of a batch.
TEST_F(MulticastSocketTest, TheHandlerMayJoinMoreThanASocketHolds) {
  Listener a(io, options(13));
  auto b = must(MulticastSocket::open(io, testing_support::clock(), options(13)));
  MulticastSocket& socket = *b;
  ASSERT_TRUE(socket.join(RegionId{0}));
  std::vector<std::uint32_t> heard;
  socket.on_receive([&](const Arrival& arrival) {
    heard.push_back(arrival.region.value);
    if (arrival.region.value > 0) return;
    for (std::uint32_t region = 1; region <= 60; ++region) EXPECT_TRUE(socket.join(RegionId{region}));
    for (std::uint32_t region = 1; region <= 60; ++region) a.send(region, "x");
  });
  a.send(0, "go");
  ASSERT_TRUE(run_until(io, [&] { return heard.size() == 61; }));
}

// ---- regions that share groups ----

class SharedGroups : public MulticastSocketTest {
 protected:
  MulticastOptions pool_of(unsigned slot, std::uint32_t pool) const {
    MulticastOptions o = options(slot, "239.192.2.0");
    o.groups.pool = pool;
    return o;
  }
};

TEST_F(SharedGroups, EachRegionIsHeardByWhoJoinedItAlone) {
  Listener a(io, pool_of(14, 4)), b(io, pool_of(14, 4));
  for (const std::uint32_t region : {3u, 70'000u, 4'000'000'000u}) b.join(region);
  EXPECT_EQ(b.socket->socket_count(), 1u);
  for (std::uint32_t region = 0; region < 100; ++region) a.send(region, std::to_string(region));
  a.send(70'000, "seventy");
  a.send(4'000'000'000u, std::string(kMaxDatagramBytes, 'x'));
  ASSERT_TRUE(run_until(io, [&] { return b.heard.size() == 3; }));
  EXPECT_THAT(b.heard, ElementsAre(Pair(3, "3"), Pair(70'000, "seventy"),
                                   Pair(4'000'000'000u, std::string(kMaxDatagramBytes, 'x'))));
  const TrafficCounters& c = b.socket->counters();
  EXPECT_GT(c.in_other_region, 0u) << "what shares its groups came to this socket, too";
  EXPECT_EQ(c.in_malformed, 0u);
}

TEST_F(SharedGroups, TheGroupStaysUntilItsLastRegionIsLeft) {
  Listener a(io, pool_of(14, 1)), b(io, pool_of(14, 1));
  b.join(1), b.join(2);
  b.leave(1);
  a.send(1, "no"), a.send(2, "yes");
  ASSERT_TRUE(run_until(io, [&] { return !b.heard.empty(); }));
  EXPECT_THAT(b.heard, ElementsAre(Pair(2, "yes")));
  EXPECT_EQ(b.socket->counters().in_other_region, 1u);
  b.leave(2);
  a.join(2);  // the computer stays in the group, the socket does not
  a.send(2, "gone");
  ASSERT_TRUE(run_until(io, [&] { return !a.heard.empty(); }));
  b.socket->receive_pending();
  EXPECT_EQ(b.heard.size(), 1u);
  EXPECT_EQ(b.socket->counters().in_other_group, 0u);
}

TEST_F(SharedGroups, WhatDoesNotSayItsRegionIsDropped) {
  Listener b(io, pool_of(14, 2));
  Listener plain(io, options(14, "239.192.2.0"));  // a peer with another plan
  b.join(0), b.join(1), b.join(2), b.join(3);
  plain.send(0, ""), plain.send(0, "no header"), plain.send(1, "R\0\0"), plain.send(1, "no header");
  Listener a(io, pool_of(14, 2));
  a.send(0, "marker");
  ASSERT_TRUE(run_until(io, [&] { return !b.heard.empty(); }));
  EXPECT_THAT(b.heard, ElementsAre(Pair(0, "marker")));
  EXPECT_EQ(b.socket->counters().in_malformed, 4u);
}

// ---- one system call for many ----

TEST_F(MulticastSocketTest, WhatIsSentInOneGoLeavesAndComesInOneCall) {
  Listener a(io, options(12)), b(io, options(12));
  b.join(1);
  for (std::size_t i = 0; i < kBatch; ++i) a.socket->send(RegionId{1}, bytes_of(std::to_string(i)));
  EXPECT_EQ(a.socket->counters().packets_out, 0u);
  a.socket->flush();
  EXPECT_EQ(a.socket->counters().packets_out, kBatch);
  EXPECT_EQ(a.socket->counters().calls_out, 1u);
  a.socket->flush();
  EXPECT_EQ(a.socket->counters().calls_out, 1u) << "nothing waits";
  b.socket->receive_pending();
  EXPECT_EQ(b.heard.size(), kBatch);
  EXPECT_EQ(b.socket->counters().calls_in, 2u) << "one that is full, and one that finds nothing more";
}

TEST_F(MulticastSocketTest, MoreThanABatchLeavesByItself) {
  Listener a(io, options(12)), b(io, options(12));
  b.join(1);
  for (std::size_t i = 0; i < kBatch + 1; ++i) a.socket->send(RegionId{1}, bytes_of("x"));
  EXPECT_EQ(a.socket->counters().packets_out, kBatch);
  a.socket->flush();
  EXPECT_EQ(a.socket->counters().packets_out, kBatch + 1);
  EXPECT_EQ(a.socket->counters().calls_out, 2u);
}

// ---- when it came ----

TEST_F(MulticastSocketTest, TheTimeIsThatOfComingNotOfReading) {
  Listener a(io, options(12)), b(io, options(12));
  b.join(1);
  // Linux begins to stamp a moment after a socket has asked for it, and stamps what came before then as it is read.
  const auto is_stamped_as_it_comes = [&] {
    a.send(1, "first");
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const HostTime read = testing_support::clock().now();
    b.socket->receive_pending();
    return !b.at.empty() && b.at.back() < read;
  };
  for (int tries = 0; tries < 2000 && !is_stamped_as_it_comes(); ++tries) {
  }
  b.at.clear();
  const HostTime before = testing_support::clock().now();
  a.send(1, "x");
  const HostTime sent = testing_support::clock().now();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const HostTime read = testing_support::clock().now();
  b.socket->receive_pending();
  ASSERT_EQ(b.at.size(), 1u);
  EXPECT_GE(b.at[0] + ArrivalClock::kRounding, before);
  EXPECT_LE(b.at[0], sent + ArrivalClock::kRounding) << "lo hands it on before send returns";
  EXPECT_LT(b.at[0], read);
  EXPECT_EQ(b.socket->counters().in_unstamped + b.socket->counters().in_stamp_refused, 0u);
}

// Asking for an interface takes a descriptor.
TEST_F(MulticastSocketTest, ALackOfDescriptorsIsNoLackOfAnInterface) {
  Listener a(io, options(0));
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  rlimit none = before;
  none.rlim_cur = 3;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none), 0);
  const auto change = a.socket->follow_interface(), again = a.socket->follow_interface();
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  ASSERT_TRUE(change);
  EXPECT_THAT(change->sentence, testing::AllOf(HasSubstr("cannot ask the system"), Not(HasSubstr("gone"))));
  EXPECT_FALSE(again) << "is said once";
  EXPECT_FALSE(a.socket->follow_interface()) << "it is there as before";
}

TEST_F(MulticastSocketTest, APortThatIsNotSharedIsRefused) {
  const udp::socket greedy(io, udp::endpoint(udp::v4(), own_port(15)));
  const NetError error = error_of(options(15));
  EXPECT_EQ(error.kind, NetError::Kind::kPortBusy);
  EXPECT_THAT(error.sentence, HasSubstr("UDP port " + std::to_string(own_port(15)) + " is held by another program"));
}

TEST_F(MulticastSocketTest, SettingsThatCannotWorkAreRefused) {
  EXPECT_EQ(error_of(options(14, "127.0.0.1")).kind, NetError::Kind::kBadSetting);
  for (const int ttl : {-1, 256}) {
    MulticastOptions wrong = options(14);
    wrong.ttl = ttl;
    EXPECT_EQ(error_of(wrong).kind, NetError::Kind::kBadSetting);
  }
}

}  // namespace peerd::net::multicast_socket_test
