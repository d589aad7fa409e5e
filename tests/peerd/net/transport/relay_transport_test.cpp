#include "peerd/net/transport/relay_transport.hpp"

#include <gtest/gtest.h>

#include "tests/peerd/net/relay/relay_fixture.hpp"

namespace peerd::net::relay_transport_test {

using namespace relay::testing_support;

using RelayTransportTest = RelayFixture;

TEST_F(RelayTransportTest, AnotherRelayTakesOverForAPeerAndForAnIsland) {
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

}  // namespace peerd::net::relay_transport_test
