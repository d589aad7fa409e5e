#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "peerd/net/relay/island.hpp"
#include "peerd/net/relay/mesh.hpp"
#include "peerd/net/relay/relay.hpp"
#include "peerd/net/transport/island_member.hpp"
#include "peerd/net/transport/relay_transport.hpp"
#include "tests/must.hpp"
#include "tests/net/listener.hpp"

// Relays, islands and peers of one process, over real sockets on lo. An island is a multicast port of its own.
namespace peerd::relay::testing_support {

namespace asio = boost::asio;
using asio::ip::udp;
using net::testing_support::bytes_of;
using net::testing_support::clock;
using net::testing_support::own_port;
using net::testing_support::run_until;
using net::testing_support::text_of;

inline constexpr unsigned kFirstIsland = 8;  // slots of ports; those before are relays and meshes

inline udp::endpoint address(unsigned slot) { return {asio::ip::address_v4::loopback(), own_port(slot)}; }

inline std::uint64_t next_key() {
  static std::uint64_t key = 0;
  return ++key;
}

inline net::MulticastOptions multicast(unsigned island) {
  return {.interface = "lo",
          .groups = *net::parse_group_plan("239.192.90.0", own_port(kFirstIsland + island)),
          .receives_own_datagrams = false};
}

struct RelayUnderTest {
  RelayUnderTest(asio::io_context& io, unsigned slot, std::vector<unsigned> parents = {},
                 std::shared_ptr<net::GreetingSeal> greeting_seal = nullptr, double budget_bytes_per_s = 0.0)
      : io_context(io), seal(std::move(greeting_seal)) {
    RelayOptions options{.port = own_port(slot), .key = {next_key(), 1}, .seal = seal};
    options.budget_bytes_per_s = budget_bytes_per_s;
    for (const unsigned parent : parents) options.parents.push_back(address(parent));
    relay = must(Relay::open(io, clock(), options, [this](bool, const std::string& line) { said.push_back(line); }));
  }
  Island& join_island(unsigned number) {
    IslandOptions options{.multicast = multicast(number), .instance = relay->instance(), .key = {next_key(), 2}};
    options.seal = seal;
    auto opened = must(Island::open(io_context, clock(), options));
    Island& island = *opened;
    relay->add(std::move(opened));
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

struct RelayFixture : testing::Test {
  std::unique_ptr<net::Transport> by_relay(std::vector<unsigned> relays,
                                           std::shared_ptr<net::GreetingSeal> seal = nullptr) {
    net::RelayTransportOptions options{.key = {next_key(), 3}, .seal = std::move(seal)};
    for (const unsigned relay : relays) options.relays.push_back(address(relay));
    return must(net::RelayTransport::open(io, clock(), options));
  }
  std::unique_ptr<net::Transport> on_island(unsigned number, std::shared_ptr<net::GreetingSeal> seal = nullptr) {
    net::MulticastOptions options = multicast(number);
    options.groups.offset = 4096;  // as of some world: the relay learns it
    auto opened = must(net::MulticastSocket::open(io, clock(), options));
    return std::make_unique<net::IslandMember>(
        clock(), std::move(opened),
        net::IslandMember::Options{.key = {next_key(), 4}, .seal = std::move(seal), .group_offset = 4096});
  }

  // Lets all do what they are about to do.
  void finish() {
    for (int i = 0; i < 20; ++i) io.restart(), io.poll();
  }

  asio::io_context io;
};

}  // namespace peerd::relay::testing_support
