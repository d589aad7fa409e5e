#include "peerd/net/relay/mesh.hpp"

#include <gtest/gtest.h>

#include "tests/must.hpp"
#include "tests/peerd/net/relay/relay_fixture.hpp"

namespace peerd::relay::mesh_test {

using namespace relay::testing_support;

using MeshTest = RelayFixture;

TEST_F(MeshTest, AMeshOfUnicastIsOneMoreNetwork) {
  RelayUnderTest relay(io, 0);
  relay.join_island(0);
  auto mesh =
      must(Mesh::open(io, clock(), {.interface = "lo", .port = own_port(3), .seeds = {address(4)}, .key = {1, 77}}));
  relay.relay->add(std::move(mesh));
  relay.relay->start();
  const auto in_mesh = [&](unsigned slot) {
    return must(net::UnicastFanOut::open(
        io, clock(), {.interface = "lo", .port = own_port(slot), .seeds = {address(4)}, .key = {next_key(), 5}}));
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

}  // namespace peerd::relay::mesh_test
