#include "peerd/relay/relay.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <set>

#include "peerd/relay/island.hpp"
#include "peerd/relay/mesh.hpp"
#include "peerd/relay/relay_report.hpp"
#include "peerd/seal/sealed_greetings.hpp"
#include "peerd/transport/island_member.hpp"
#include "peerd/transport/relay_transport.hpp"
#include "tests/net/listener.hpp"

// Relays, islands and peers of one process, over real sockets on lo. An island is a multicast port of its own.
namespace peerd::relay::relay_test {

namespace asio = boost::asio;
using asio::ip::udp;
using net::testing_support::bytes_of;
using net::testing_support::clock;
using net::testing_support::own_port;
using net::testing_support::run_until;
using net::testing_support::text_of;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

constexpr unsigned kFirstIsland = 8;  // slots of ports; those before are relays and meshes

udp::endpoint address(unsigned slot) { return {asio::ip::address_v4::loopback(), own_port(slot)}; }

std::uint64_t next_key() {
  static std::uint64_t key = 0;
  return ++key;
}

net::MulticastOptions multicast(unsigned island) {
  net::MulticastOptions options;
  options.interface = "lo";
  options.groups = *net::parse_group_plan("239.192.90.0", own_port(kFirstIsland + island));
  options.receives_own_datagrams = false;
  return options;
}

struct RelayUnderTest {
  RelayUnderTest(asio::io_context& io, unsigned slot, std::vector<unsigned> parents = {},
                 std::shared_ptr<net::GreetingSeal> greeting_seal = nullptr, double budget_bytes_per_s = 0.0)
      : io_context(io), seal(std::move(greeting_seal)) {
    RelayOptions options{.port = own_port(slot), .key = {next_key(), 1}, .seal = seal};
    options.budget_bytes_per_s = budget_bytes_per_s;
    for (const unsigned parent : parents) options.parents.push_back(address(parent));
    auto opened = Relay::open(io, clock(), options, [this](bool, const std::string& line) { said.push_back(line); });
    if (!opened) throw std::runtime_error(opened.error().sentence);
    relay = *std::move(opened);
  }
  Island& join_island(unsigned number) {
    IslandOptions options{.multicast = multicast(number), .instance = relay->instance(), .key = {next_key(), 2}};
    options.seal = seal;
    auto opened = Island::open(io_context, clock(), options);
    if (!opened) throw std::runtime_error(opened.error().sentence);
    Island& island = **opened;
    relay->add(*std::move(opened));
    return island;
  }
  [[nodiscard]] std::size_t peers() const {
    std::size_t count = 0;
    relay->neighbours().visit([&](const Neighbour& each) { count += each.is_relay ? 0 : 1; });
    return count;
  }

  asio::io_context& io_context;
  std::shared_ptr<net::GreetingSeal> seal;
  std::vector<std::string> said;
  std::unique_ptr<Relay> relay;
};

// A peer, by a relay or on an island, that records what it receives.
struct Peer {
  explicit Peer(std::unique_ptr<net::Transport> opened, std::initializer_list<std::uint32_t> regions = {0})
      : transport(std::move(opened)) {
    transport->on_receive([this](const net::Arrival& arrival) {
      heard.push_back(std::to_string(arrival.region.value) + " " + text_of(arrival.datagram));
    });
    for (const std::uint32_t region : regions) join(region);
  }
  void join(std::uint32_t region) {
    EXPECT_TRUE(transport->join(RegionId{region}));
    transport->flush();
  }
  void leave(std::uint32_t region) {
    EXPECT_TRUE(transport->leave(RegionId{region}));
    transport->flush();
  }
  void send(std::uint32_t region, std::string_view text) {
    transport->send(RegionId{region}, bytes_of(text));
    transport->flush();
  }
  [[nodiscard]] const net::RelayTransport& through() const {
    return dynamic_cast<const net::RelayTransport&>(*transport);
  }
  [[nodiscard]] bool can_send(std::uint32_t region) const {
    const auto* const relay = through().relay();
    return relay != nullptr && net::RelayChoice::wants(*relay, RegionId{region});
  }

  std::unique_ptr<net::Transport> transport;
  std::vector<std::string> heard;
};

struct RelayTest : testing::Test {
  std::unique_ptr<net::Transport> by_relay(std::vector<unsigned> relays,
                                           std::shared_ptr<net::GreetingSeal> seal = nullptr) {
    net::RelayTransportOptions options{.key = {next_key(), 3}, .seal = std::move(seal)};
    for (const unsigned relay : relays) options.relays.push_back(address(relay));
    auto opened = net::RelayTransport::open(io, clock(), options);
    if (!opened) throw std::runtime_error(opened.error().sentence);
    return *std::move(opened);
  }
  std::unique_ptr<net::Transport> on_island(unsigned number, std::shared_ptr<net::GreetingSeal> seal = nullptr) {
    net::MulticastOptions options = multicast(number);
    options.groups.offset = 4096;  // as of some world: the relay learns it
    auto opened = net::MulticastSocket::open(io, clock(), options);
    if (!opened) throw std::runtime_error(opened.error().sentence);
    return std::make_unique<net::IslandMember>(
        clock(), *std::move(opened),
        net::IslandMember::Options{.key = {next_key(), 4}, .seal = std::move(seal), .group_offset = 4096});
  }

  // Lets all do what they are about to do.
  void finish() {
    for (int i = 0; i < 20; ++i) io.restart(), io.poll();
  }

  asio::io_context io;
};

TEST_F(RelayTest, PassesARegionOnToThoseWhoWantItAlone) {
  RelayUnderTest relay(io, 0);
  relay.relay->start();
  Peer a(by_relay({0}), {0, 5}), b(by_relay({0}), {0, 5}), c(by_relay({0}), {0, 6});
  ASSERT_TRUE(run_until(io, [&] { return a.can_send(5) && a.can_send(6) && b.can_send(5) && c.can_send(5); }));
  a.send(5, "of a");
  b.send(0, "of b");
  c.send(6, "nobody else wants it");
  ASSERT_TRUE(run_until(io, [&] { return a.heard.size() == 1 && b.heard.size() == 1 && c.heard.size() == 1; }));
  EXPECT_THAT(a.heard, ElementsAre("0 of b"));
  EXPECT_THAT(b.heard, ElementsAre("5 of a"));
  EXPECT_THAT(c.heard, ElementsAre("0 of b"));
  EXPECT_EQ(c.transport->counters().out_unwanted, 1u);
  EXPECT_EQ(relay.relay->counters().forwarded, 3u);
  b.leave(5);
  ASSERT_TRUE(run_until(io, [&] { return !a.can_send(5); }));
}

// The way of a datagram: island, relay, root, relay, island; and a single peer at the root.
TEST_F(RelayTest, ATreeJoinsIslandsAndSinglePeers) {
  RelayUnderTest root(io, 0), left(io, 1, {0}), right(io, 2, {0});
  left.join_island(0), right.join_island(1);
  for (auto* each : {&root, &left, &right}) each->relay->start();
  Peer a(on_island(0), {0, 5}), a2(on_island(0), {0}), b(on_island(1), {0, 5}), c(by_relay({0}), {0, 7});
  const auto all_know = [&] {
    return left.relay->table().wanted_by_others(0).regions == std::vector{RegionId{0}, RegionId{5}, RegionId{7}} &&
           right.relay->table().wanted_by_others(0).regions == std::vector{RegionId{0}, RegionId{5}, RegionId{7}} &&
           c.can_send(5);
  };
  ASSERT_TRUE(run_until(io, all_know));
  finish();
  a.send(5, "across"), c.send(5, "to both"), b.send(7, "to the single one"), a2.send(0, "to all");
  ASSERT_TRUE(run_until(io, [&] { return a.heard.size() == 2 && b.heard.size() == 3 && c.heard.size() == 2; }));
  EXPECT_THAT(a.heard, UnorderedElementsAre("5 to both", "0 to all"));
  EXPECT_THAT(a2.heard, IsEmpty());
  EXPECT_THAT(b.heard, UnorderedElementsAre("5 across", "5 to both", "0 to all"));
  EXPECT_THAT(c.heard, UnorderedElementsAre("7 to the single one", "0 to all"));
  EXPECT_EQ(left.relay->path().size(), 2u);
  EXPECT_EQ(left.relay->path().back(), root.relay->instance());
}

// What no other island wants does not leave its own, and is not even received by the relay there.
TEST_F(RelayTest, WhatNobodyElseWantsStaysOnItsIsland) {
  RelayUnderTest root(io, 0), left(io, 1, {0}), right(io, 2, {0});
  left.join_island(0), right.join_island(1);
  for (auto* each : {&root, &left, &right}) each->relay->start();
  Peer a(on_island(0), {0, 5}), a2(on_island(0), {0, 5}), b(on_island(1), {0, 6});
  ASSERT_TRUE(run_until(io, [&] { return left.relay->table().wanted_by_others(0).regions.size() == 2; }));
  finish();
  const auto before = left.relay->ports()[0]->counters().packets_in;
  for (int i = 0; i < 50; ++i) a.send(5, "local");
  a.send(0, "done");
  ASSERT_TRUE(run_until(io, [&] { return !b.heard.empty() && a2.heard.size() == 51; }));
  EXPECT_THAT(b.heard, ElementsAre("0 done"));
  EXPECT_LT(left.relay->ports()[0]->counters().packets_in - before, 50u);
}

TEST_F(RelayTest, AnotherRelayTakesOverForAPeerAndForAnIsland) {
  asio::io_context io_of_first;  // nobody runs it once the first relay has died
  bool is_alive = true;
  RelayUnderTest first(io_of_first, 0), second(io, 1, {0}), island_relay(io, 2, {0, 1});
  island_relay.join_island(0);
  for (auto* each : {&first, &second, &island_relay}) each->relay->start();
  Peer a(by_relay({0, 1})), b(on_island(0));
  const auto meet = [&](const std::string& text) {
    const auto got = [&](const Peer& peer) { return std::ranges::find(peer.heard, "0 " + text) != peer.heard.end(); };
    return run_until(io, [&] {
      if (is_alive) io_of_first.restart(), io_of_first.poll();
      a.send(0, text), b.send(0, text);
      return got(a) && got(b);
    });
  };
  ASSERT_TRUE(meet("by the first"));
  ASSERT_EQ(a.through().relay()->at, address(0));
  is_alive = false;  // without a word, as after a power failure
  ASSERT_TRUE(meet("by the second"));
  EXPECT_EQ(a.through().relay()->at, address(1));
  EXPECT_EQ(island_relay.relay->parents().chosen()->at, address(1));
}

// Both hear all of the island; exactly one passes it on, and the other one when the first is gone.
TEST_F(RelayTest, OfTwoRelaysOnAnIslandOneIsActive) {
  RelayUnderTest root(io, 0);
  auto one = std::make_unique<RelayUnderTest>(io, 1, std::vector{0u});
  auto two = std::make_unique<RelayUnderTest>(io, 2, std::vector{0u});
  Island *const island_of_one = &one->join_island(0), *const island_of_two = &two->join_island(0);
  root.relay->start(), one->relay->start(), two->relay->start();
  Peer a(on_island(0)), b(by_relay({0}));
  ASSERT_TRUE(run_until(io, [&] {
    return (island_of_one->is_active() != island_of_two->is_active()) && root.relay->neighbours().count() == 3 &&
           b.can_send(0);
  }));
  int sent = 0;
  ASSERT_TRUE(run_until(io, [&] {
    if (b.heard.empty()) a.send(0, std::to_string(sent++));
    return !b.heard.empty();
  }));
  b.heard.clear();
  for (int i = 0; i < 20; ++i) a.send(0, "once");
  b.send(0, "back once");
  ASSERT_TRUE(run_until(io, [&] { return b.heard.size() >= 20 && !a.heard.empty(); }));
  EXPECT_EQ(std::ranges::count(b.heard, "0 once"), 20);
  EXPECT_THAT(a.heard, ElementsAre("0 back once"));
  (island_of_one->is_active() ? one : two).reset();
  b.heard.clear();
  ASSERT_TRUE(run_until(io, [&] {
    a.send(0, "by the other");
    return !b.heard.empty();
  }));
}

TEST_F(RelayTest, RelaysInACircleAgreeOnARoot) {
  RelayUnderTest one(io, 0, {1}), two(io, 1, {2}), three(io, 2, {0});
  for (auto* each : {&one, &two, &three}) each->relay->start();
  const auto all = {&one, &two, &three};
  const auto roots = [&] {
    return std::ranges::count_if(all, [](const auto* each) { return each->relay->path().size() == 1; });
  };
  ASSERT_TRUE(run_until(io, [&] {
    return roots() == 1 &&
           std::ranges::any_of(all, [](const auto* each) { return each->relay->path().size() == 3; });
  }));
  Peer a(by_relay({0})), b(by_relay({1})), c(by_relay({2}));
  ASSERT_TRUE(run_until(io, [&] { return a.can_send(0) && b.can_send(0) && c.can_send(0); }));
  a.send(0, "round");
  ASSERT_TRUE(run_until(io, [&] { return !b.heard.empty() && !c.heard.empty(); }));
  EXPECT_THAT(a.heard, IsEmpty());
  EXPECT_EQ(b.heard.size() + c.heard.size(), 2u);
}

TEST_F(RelayTest, AMeshOfUnicastIsOneMoreNetwork) {
  RelayUnderTest relay(io, 0);
  relay.join_island(0);
  auto mesh = Mesh::open(io, clock(), {.interface = "lo", .port = own_port(3), .seeds = {address(4)}, .key = {1, 77}});
  ASSERT_TRUE(mesh);
  relay.relay->add(*std::move(mesh));
  relay.relay->start();
  const auto in_mesh = [&](unsigned slot) {
    auto opened = net::UnicastFanOut::open(
        io, clock(), {.interface = "lo", .port = own_port(slot), .seeds = {address(4)}, .key = {next_key(), 5}});
    if (!opened) throw std::runtime_error(opened.error().sentence);
    return *std::move(opened);
  };
  Peer a(in_mesh(4), {0, 5}), b(in_mesh(5), {0, 5}), c(on_island(0), {0, 5}), d(by_relay({0}), {0, 5});
  const auto each = [&](const std::string& text) {
    for (const Peer* peer : {&a, &b, &c, &d}) {
      if (std::ranges::count(peer->heard, "5 " + text) == 0) return false;
    }
    return true;
  };
  int turn = 0;
  ASSERT_TRUE(run_until(io, [&] {
    const std::string text = std::to_string(++turn / 50);
    if (turn % 50 == 1) {
      for (Peer* peer : {&a, &b, &c, &d}) peer->send(5, text);
    }
    return each(text);
  }));
  for (Peer* peer : {&a, &b, &c, &d}) peer->heard.clear();
  for (Peer* peer : {&a, &b, &c, &d}) peer->send(5, "once");
  ASSERT_TRUE(run_until(io, [&] {
    return std::ranges::all_of(std::array{&a, &b, &c, &d},
                               [](const Peer* peer) { return std::ranges::count(peer->heard, "5 once") >= 3; });
  }));
  finish();
  for (const Peer* peer : {&a, &b, &c, &d}) EXPECT_EQ(std::ranges::count(peer->heard, "5 once"), 3);
}

TEST_F(RelayTest, SealedGreetingsMeetByTheRelaysKeyAlone) {
  const auto session = seal::SymmetricKey::random();
  const auto sealed_by = [](const seal::SymmetricKey& key) {
    return std::make_shared<seal::SealedGreetings>(seal::SealedGreetings::key_of(key), [](const std::string&) {});
  };
  RelayUnderTest relay(io, 0, {}, sealed_by(session));
  relay.join_island(0);
  relay.relay->start();
  Peer a(by_relay({0}, sealed_by(session))), b(on_island(0, sealed_by(session))), open(by_relay({0})),
      other(by_relay({0}, sealed_by(seal::SymmetricKey::random())));
  ASSERT_TRUE(run_until(io, [&] {
    if (a.can_send(0)) a.send(0, "sealed");
    return !b.heard.empty();
  }));
  EXPECT_EQ(relay.peers(), 1u);
  EXPECT_EQ(open.through().relay(), nullptr);
  EXPECT_EQ(other.through().relay(), nullptr);
  EXPECT_GT(relay.relay->traffic().greetings_unopened, 0u);
}

// Whoever has not echoed its number is not heard, and gets no more bytes than it has sent.
TEST_F(RelayTest, AStrangerIsNotHeardAndGetsNoMoreThanItSent) {
  RelayUnderTest relay(io, 0);
  relay.relay->start();
  Peer a(by_relay({0}));
  ASSERT_TRUE(run_until(io, [&] { return relay.peers() == 1; }));
  udp::socket stranger(io, udp::endpoint(asio::ip::address_v4::loopback(), 0));
  const auto header = net::relay_header({RegionId{0}});
  std::vector<std::byte> datagram(header.begin(), header.end());
  datagram.resize(100);
  net::Greeting claims{.instance = 9, .number = 1, .echo = 12'345};
  claims.link = net::LinkNote{.sent_at_ns = 1};
  claims.regions = {RegionId{0}};
  const auto greeting = net::encode(claims, true);
  stranger.send_to(asio::buffer(datagram), address(0));
  stranger.send_to(asio::buffer(greeting), address(0));
  ASSERT_TRUE(run_until(io, [&] { return relay.relay->traffic().in_stranger == 1 && stranger.available() > 0; }));
  std::array<std::byte, 2000> answer{};
  EXPECT_LE(stranger.receive(asio::buffer(answer)), greeting.size());
  EXPECT_EQ(relay.peers(), 1u);
  EXPECT_THAT(a.heard, IsEmpty());
}

TEST_F(RelayTest, DatagramsThatGoRoundEnd) {
  RelayUnderTest relay(io, 0);
  relay.relay->start();
  Peer a(by_relay({0})), b(by_relay({0}));
  ASSERT_TRUE(run_until(io, [&] { return a.can_send(0) && b.can_send(0); }));
  // A neighbour passes on what has been through all relays that it may.
  udp::socket raw(io, udp::endpoint(asio::ip::address_v4::loopback(), 0));
  net::Greeting greeting{.instance = 7, .reply = true};
  raw.send_to(asio::buffer(net::encode(greeting, true)), address(0));
  ASSERT_TRUE(run_until(io, [&] { return raw.available() > 0; }));
  std::array<std::byte, 2000> answer{};
  const auto size = raw.receive(asio::buffer(answer));
  const auto answered = net::decode_greeting(std::span(answer).first(size), true);
  ASSERT_TRUE(answered);
  greeting = {.instance = 7, .number = 3, .echo = answered->number};
  greeting.link = net::LinkNote{.sent_at_ns = 1};
  raw.send_to(asio::buffer(net::encode(greeting, true)), address(0));
  ASSERT_TRUE(run_until(io, [&] { return relay.peers() == 3; }));
  for (const std::uint8_t hops : {std::uint8_t{0}, std::uint8_t{1}}) {
    const auto header = net::relay_header({RegionId{0}, hops});
    raw.send_to(asio::buffer(header), address(0));
  }
  ASSERT_TRUE(run_until(io, [&] { return a.heard.size() + b.heard.size() == 2; }));
  EXPECT_EQ(relay.relay->counters().out_of_hops, 1u);
}

TEST_F(RelayTest, ABudgetLimitsALinkAndIsCounted) {
  RelayUnderTest relay(io, 0, {}, nullptr, /*budget_bytes_per_s=*/4'000.0);
  relay.relay->start();
  Peer a(by_relay({0})), b(by_relay({0}), {0, 5});
  ASSERT_TRUE(run_until(io, [&] { return a.can_send(5) && a.can_send(0); }));
  const std::string text(494, 'x');  // 500 bytes with the header: three at once, and one more for all
  for (int i = 0; i < 20; ++i) a.send(5, text);
  a.send(0, "for all");
  ASSERT_TRUE(run_until(io, [&] { return !b.heard.empty() && b.heard.back() == "0 for all"; }));
  EXPECT_GE(b.heard.size(), 4u);
  EXPECT_LT(b.heard.size(), 12u);
  EXPECT_GT(relay.relay->counters().over_budget, 8u);
  const auto report = report_of(*relay.relay);
  EXPECT_EQ(report["counters"]["relay.over_budget"], relay.relay->counters().over_budget);
  EXPECT_EQ(report["links"].size(), 2u);
}

TEST_F(RelayTest, ASilentPeerIsForgotten) {
  RelayUnderTest relay(io, 0);
  relay.relay->start();
  Peer a(by_relay({0}), {0, 5});
  {
    Peer b(by_relay({0}), {0, 6});
    ASSERT_TRUE(run_until(io, [&] { return relay.peers() == 2 && a.can_send(6); }));
  }
  ASSERT_TRUE(run_until(io, [&] { return relay.peers() == 1 && !a.can_send(6); }));
}

}  // namespace peerd::relay::relay_test
