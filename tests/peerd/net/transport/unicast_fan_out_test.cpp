#include "peerd/net/transport/unicast_fan_out.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/ip/udp.hpp>

#include "peerd/net/seal/sealed_greetings.hpp"
#include "tests/must.hpp"
#include "tests/net/listener.hpp"
#include "tests/net/wire.hpp"

namespace peerd::net::unicast_fan_out_test {

using asio::ip::udp;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
using testing_support::bytes_of;
using testing_support::clock;
using testing_support::own_port;
using testing_support::run_until;
using testing_support::shell;
using testing_support::text_of;

udp::endpoint address(unsigned slot) { return {asio::ip::address_v4::loopback(), own_port(slot)}; }

// A peer on lo that records what it receives.
struct UnicastPeer {
  UnicastPeer(asio::io_context& io, unsigned slot, std::vector<udp::endpoint> seeds, std::uint64_t start = 1,
              std::shared_ptr<GreetingSeal> seal = nullptr) {
    transport = must(UnicastFanOut::open(io, clock(),
                                         {.interface = "lo",
                                          .port = own_port(slot),
                                          .seeds = std::move(seeds),
                                          .key = {start, slot},
                                          .seal = std::move(seal)}));
    transport->on_receive([this](const Arrival& arrival) {
      heard.emplace_back(arrival.region.value, text_of(arrival.datagram));
      at.push_back(arrival.at);
    });
  }
  void join(std::uint32_t region) {
    EXPECT_TRUE(transport->join(RegionId{region}));
    transport->flush();
  }
  void send(std::uint32_t region, std::string_view text) {
    transport->send(RegionId{region}, bytes_of(text));
    transport->flush();
  }
  // Waits until it knows that so many peers want that region.
  [[nodiscard]] bool knows(std::size_t count, std::uint32_t region) const {
    const auto wants = [&](const auto& peer) { return KnownPeers::wants(peer, RegionId{region}); };
    return std::ranges::count_if(transport->peers(), wants) == static_cast<std::ptrdiff_t>(count);
  }

  std::vector<std::pair<std::uint32_t, std::string>> heard;
  std::vector<HostTime> at;
  std::unique_ptr<UnicastFanOut> transport;
};

struct UnicastFanOutTest : testing::Test {
  asio::io_context io;
};

TEST_F(UnicastFanOutTest, OneSeedIsEnoughForThreeToMeet) {
  UnicastPeer a(io, 0, {}), b(io, 1, {address(0)}), c(io, 2, {address(0)});
  for (auto* peer : {&a, &b, &c}) peer->join(1);
  ASSERT_TRUE(run_until(io, [&] { return a.knows(2, 1) && b.knows(2, 1) && c.knows(2, 1); }));
  a.send(1, "from a"), b.send(1, "from b"), c.send(1, "from c");
  ASSERT_TRUE(run_until(io, [&] { return a.heard.size() == 2 && b.heard.size() == 2 && c.heard.size() == 2; }));
  EXPECT_THAT(a.heard, ElementsAre(Pair(1, "from b"), Pair(1, "from c")));
  EXPECT_THAT(b.heard, ElementsAre(Pair(1, "from a"), Pair(1, "from c")));
  EXPECT_THAT(c.heard, ElementsAre(Pair(1, "from a"), Pair(1, "from b")));
  for (auto* peer : {&a, &b, &c}) {
    EXPECT_EQ(peer->transport->counters().in_malformed, 0u);
    EXPECT_EQ(peer->transport->counters().in_unstamped + peer->transport->counters().in_stamp_refused, 0u);
  }
}

// A late joiner does not wait for a round: no timer runs in this test.
TEST_F(UnicastFanOutTest, ThreeMessagesAreEnoughToKnowWhatTheOtherWants) {
  UnicastPeer a(io, 0, {});
  a.join(1);
  UnicastPeer b(io, 1, {address(0)});
  b.join(2);
  for (int i = 0; i < 3; ++i) {
    a.transport->receive_pending();
    b.transport->receive_pending();
  }
  EXPECT_TRUE(a.knows(1, 2));
  EXPECT_TRUE(b.knows(1, 1));
  UnicastPeer c(io, 2, {address(0)});
  const auto go_on = [&] {
    for (int i = 0; i < 10; ++i) {
      for (auto* peer : {&a, &b, &c}) {
        peer->transport->receive_pending();
        peer->transport->flush();
      }
    }
  };
  go_on();
  for (auto* peer : {&a, &b, &c})
    EXPECT_EQ(peer->transport->peers().size(), 2u) << "a has introduced b and c to each other";
  const auto before = a.transport->counters().greetings_out;
  go_on();
  EXPECT_EQ(a.transport->counters().greetings_out, before) << "and then it is quiet";
}

// A peer with another key, or with none, gets no answer and is known to nobody, whomever it greets.
TEST_F(UnicastFanOutTest, SealedGreetingsMeetBySessionKeyAlone) {
  const auto key = keys::SymmetricKey::random();
  const auto by = [](const keys::SymmetricKey& session) {
    return std::make_shared<seal::SealedGreetings>(seal::SealedGreetings::key_of(session), [](const std::string&) {});
  };
  UnicastPeer a(io, 0, {}, 1, by(key)), b(io, 1, {address(0)}, 1, by(key));
  UnicastPeer other(io, 2, {address(0), address(1)}, 1, by(keys::SymmetricKey::random()));
  UnicastPeer open(io, 3, {address(0), address(1)});
  for (auto* peer : {&a, &b, &other, &open}) peer->join(1);
  ASSERT_TRUE(run_until(io, [&] {
    return a.knows(1, 1) && b.knows(1, 1) && a.transport->counters().greetings_unopened >= 4 &&
           b.transport->counters().greetings_unopened >= 4;
  }));
  a.send(1, "from a"), other.send(1, "by another key"), open.send(1, "in the clear");
  ASSERT_TRUE(run_until(io, [&] { return !b.heard.empty(); }));
  EXPECT_THAT(b.heard, ElementsAre(Pair(1, "from a")));
  for (auto* peer : {&other, &open}) {
    EXPECT_THAT(peer->transport->peers(), IsEmpty());
    EXPECT_EQ(peer->transport->counters().greetings_in, 0u);
    EXPECT_EQ(peer->transport->counters().greetings_unopened, 0u) << "nobody has answered";
  }
  for (auto* peer : {&a, &b}) EXPECT_EQ(peer->transport->peers().size(), 1u);
}

// The sender filters by region, and the receiver drops datagrams that cross with its leaving.
TEST_F(UnicastFanOutTest, ARegionGoesToWhoWantsItAlone) {
  UnicastPeer a(io, 0, {}), b(io, 1, {address(0)}), c(io, 2, {address(0)});
  b.join(1), b.join(2), c.join(2);
  ASSERT_TRUE(run_until(io, [&] { return a.knows(1, 1) && a.knows(2, 2); }));
  const auto before = a.transport->counters().packets_out - a.transport->counters().greetings_out;
  a.send(1, "one"), a.send(2, "two"), a.send(3, "three");
  EXPECT_EQ(a.transport->counters().packets_out - a.transport->counters().greetings_out, before + 3);
  ASSERT_TRUE(run_until(io, [&] { return b.heard.size() == 2 && !c.heard.empty(); }));
  EXPECT_THAT(b.heard, ElementsAre(Pair(1, "one"), Pair(2, "two")));
  EXPECT_THAT(c.heard, ElementsAre(Pair(2, "two")));

  EXPECT_TRUE(b.transport->leave(RegionId{1}));  // not flushed, so a does not know of it
  a.send(1, "too late"), a.send(2, "marker");
  ASSERT_TRUE(run_until(io, [&] { return b.heard.size() == 3; }));
  EXPECT_THAT(b.heard.back(), Pair(2, "marker"));
  EXPECT_EQ(b.transport->counters().in_other_region, 1u);
  b.transport->flush();
  ASSERT_TRUE(run_until(io, [&] { return a.knows(0, 1); }));
}

TEST_F(UnicastFanOutTest, WhoLeavesIsSentNothingMore) {
  UnicastPeer a(io, 0, {});
  {
    UnicastPeer b(io, 1, {address(0)});
    b.join(1);
    ASSERT_TRUE(run_until(io, [&] { return a.knows(1, 1); }));
  }
  a.transport->receive_pending();  // lo has it there by now
  EXPECT_THAT(a.transport->peers(), IsEmpty()) << "by a goodbye, not by 5 s of silence";
}

// A peer has crashed and restarted: peers that still greet the old process learn of the new one at once.
TEST_F(UnicastFanOutTest, APeerWithAStaleInstanceIsAnswered) {
  UnicastPeer a(io, 0, {});
  udp::socket other(io, udp::endpoint(asio::ip::address_v4::loopback(), 0));
  other.non_blocking(true);
  const auto answer_to = [&](const Greeting& greeting) -> std::optional<Greeting> {
    other.send_to(asio::buffer(encode(greeting, true)), address(0));
    a.transport->receive_pending();
    std::array<std::byte, 2000> bytes{};
    boost::system::error_code ec;
    const std::size_t size = other.receive(asio::buffer(bytes), 0, ec);
    return ec ? std::nullopt : decode_greeting(std::span(bytes).first(size), true);
  };
  const auto answer = must(answer_to({.instance = 5, .number = 6, .echo = 12345}));
  EXPECT_NE(answer.instance, 5u);
  EXPECT_NE(answer.number, 0u);
  EXPECT_EQ(answer.echo, 6u);
  EXPECT_TRUE(answer.reply);
  EXPECT_FALSE(answer_to({.instance = 5, .echo = 12345, .leaving = true}));
  EXPECT_FALSE(answer_to({.instance = 5}));
  EXPECT_THAT(a.transport->peers(), IsEmpty());
}

// Other programs may send hostile datagrams to our port.
TEST_F(UnicastFanOutTest, StrangeDatagramsAreCountedAndMakeNobodyAPeer) {
  UnicastPeer a(io, 0, {});
  a.join(1);
  udp::socket outsider(io, udp::endpoint(asio::ip::address_v4::loopback(), 0));
  outsider.non_blocking(true);
  const auto send = [&](std::string_view text) { outsider.send_to(asio::buffer(text), address(0)); };
  send(""), send("R"), send("G not a greeting"), send(std::string(3000, 'G'));
  const auto forged = encode({.instance = 5, .echo = 12345, .reply = true}, true);
  outsider.send_to(asio::buffer(forged), address(0));
  ASSERT_TRUE(run_until(io, [&] { return a.transport->counters().greetings_in == 1; }));
  EXPECT_EQ(a.transport->counters().in_malformed, 3u);
  EXPECT_EQ(a.transport->counters().in_truncated, 1u);
  EXPECT_THAT(a.transport->peers(), IsEmpty());
  a.send(1, "secret");
  std::array<std::byte, 2000> bytes{};
  boost::system::error_code ec;
  std::size_t answered = 0;
  for (std::size_t size; (size = outsider.receive(asio::buffer(bytes), 0, ec)) > 0 && !ec;) answered += size;
  EXPECT_LE(answered, forged.size()) << "no more comes back than went there";
}

// A program that is no peer, at a port of its own.
struct Outsider {
  explicit Outsider(asio::io_context& io) : socket(io, udp::endpoint(asio::ip::address_v4::loopback(), 0)) {
    socket.non_blocking(true);
  }
  void send(const std::vector<std::byte>& bytes) { socket.send_to(asio::buffer(bytes), address(0)); }
  void send_datagram(std::uint32_t region, std::string_view text) {
    const auto header = region_header(RegionId{region});
    std::vector<std::byte> bytes(header.begin(), header.end());
    for (const char letter : text) bytes.push_back(static_cast<std::byte>(letter));
    send(bytes);
  }
  // The next waiting datagram; empty where there is none.
  std::vector<std::byte> receive() {
    std::vector<std::byte> bytes(2000);
    boost::system::error_code ec;
    bytes.resize(socket.receive(asio::buffer(bytes), 0, ec));
    return bytes;
  }
  udp::socket socket;
};

TEST_F(UnicastFanOutTest, NobodyIsHeardBeforeItHasEchoed) {
  UnicastPeer a(io, 0, {});
  a.join(1);
  const TrafficCounters& counters = a.transport->counters();
  Outsider other(io);
  other.send_datagram(1, "never greeted");
  a.transport->receive_pending();
  EXPECT_EQ(counters.in_stranger, 1u);

  other.send(encode({.instance = 5, .number = 6, .reply = true}, true));
  a.transport->receive_pending();
  const auto answer = must(decode_greeting(other.receive(), true));
  other.send_datagram(1, "greeted, not echoed");
  a.transport->receive_pending();
  EXPECT_EQ(counters.in_stranger, 2u);
  EXPECT_THAT(a.heard, IsEmpty());

  other.send(encode({.instance = 5, .number = 6, .echo = answer.number}, true));
  other.send_datagram(1, "echoed");
  a.transport->receive_pending();
  EXPECT_THAT(a.heard, ElementsAre(Pair(1, "echoed")));
  other.send(encode({.instance = 5, .number = 6, .echo = answer.number, .leaving = true}, true));
  other.send_datagram(1, "left");
  a.transport->receive_pending();
  EXPECT_EQ(a.heard.size(), 1u);
  EXPECT_EQ(counters.in_stranger, 3u);
  EXPECT_EQ(counters.packets_in, 1u);
}

TEST_F(UnicastFanOutTest, WhatIsTooLargeIsACountedDropAndTheLongestIsNot) {
  UnicastPeer a(io, 0, {}), b(io, 1, {address(0)});
  b.join(1);
  ASSERT_TRUE(run_until(io, [&] { return a.knows(1, 1); }));
  a.send(1, std::string(kMaxDatagramBytes + 1, 'x'));
  a.send(1, std::string(kMaxDatagramBytes, 'y'));
  ASSERT_TRUE(run_until(io, [&] { return !b.heard.empty(); }));
  EXPECT_THAT(b.heard, ElementsAre(Pair(1, std::string(kMaxDatagramBytes, 'y'))));
  EXPECT_EQ(a.transport->counters().out_too_large, 1u);
}

// With interface "lo" a peer stays on its computer, although its port is open on all interfaces.
TEST_F(UnicastFanOutTest, WhatComesOverAnotherInterfaceIsDropped) {
  testing_support::with_wire([&](const testing_support::Wire& wire) {
    wire.left.enter();
    std::vector<std::unique_ptr<UnicastFanOut>> peers;
    for (const char* interface : {"lo", "va", ""}) {
      const auto slot = static_cast<unsigned>(peers.size());
      auto opened =
          UnicastFanOut::open(io, clock(), {.interface = interface, .port = own_port(slot), .key = {9, slot}});
      ASSERT_TRUE(opened) << opened.error().sentence;
      peers.push_back(*std::move(opened));
      peers.back()->on_receive([](const Arrival&) {});
    }
    wire.right.enter();
    udp::socket other(io, udp::v4());
    const auto greeting = encode({.instance = 5}, true);
    const auto count = [&](std::size_t peer) {
      const TrafficCounters& c = peers[peer]->counters();
      return std::pair(c.greetings_in, c.in_other_interface);
    };
    for (unsigned slot = 0; slot < peers.size(); ++slot) {
      other.send_to(asio::buffer(greeting), {asio::ip::make_address("192.0.2.1"), own_port(slot)});
      ASSERT_TRUE(run_until(io, [&] { return count(slot) != std::pair<std::uint64_t, std::uint64_t>(0, 0); }));
    }
    EXPECT_THAT(count(0), Pair(0u, 1u));
    EXPECT_THAT(count(1), Pair(1u, 0u));
    EXPECT_THAT(count(2), Pair(1u, 0u));
    wire.left.enter();  // another peer of the computer, by whichever of its addresses
    udp::socket near(io, udp::v4());
    for (const char* address : {"192.0.2.1", "127.0.0.1"}) {
      near.send_to(asio::buffer(greeting), {asio::ip::make_address(address), own_port(1)});
    }
    ASSERT_TRUE(run_until(io, [&] { return count(1).first == 3; })) << count(1).second;
  });
}

TEST_F(UnicastFanOutTest, AnInterfaceThatIsMadeAnewIsFollowed) {
  testing_support::with_wire([&](const testing_support::Wire& wire) {
    wire.left.enter();
    auto opened = must(UnicastFanOut::open(io, clock(), {.interface = "va", .port = own_port(0), .key = {9, 0}}));
    UnicastFanOut& peer = *opened;
    peer.on_receive([](const Arrival&) {});
    ASSERT_TRUE(shell("ip link del va"));
    EXPECT_FALSE(must(peer.follow_interface()).is_back);
    EXPECT_FALSE(peer.follow_interface()) << "is said once";
    ASSERT_EQ(wire.connect(), "");
    wire.left.enter();
    EXPECT_TRUE(must(peer.follow_interface()).is_back);
    wire.right.enter();
    udp::socket other(io, udp::v4());
    other.send_to(asio::buffer(encode({.instance = 5}, true)), {asio::ip::make_address("192.0.2.1"), own_port(0)});
    ASSERT_TRUE(run_until(io, [&] { return peer.counters().greetings_in == 1; }));
  });
}

TEST_F(UnicastFanOutTest, APortOfSomebodyElseIsRefused) {
  const UnicastPeer a(io, 0, {});
  EXPECT_THAT(error_of(UnicastFanOut::open(io, clock(), {.port = own_port(0), .key = {2, 0}})),
              IsError(NetError::Kind::kPortBusy, HasSubstr("give this peer another port")));
}

}  // namespace peerd::net::unicast_fan_out_test
