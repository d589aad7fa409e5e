// In steady state no datagram costs memory from the heap, whichever way it goes.
#include <gtest/gtest.h>

#include "peerd/net/unicast_fan_out.hpp"
#include "tests/net/allocation_meter.hpp"
#include "tests/net/listener.hpp"

namespace peerd::net {
namespace {

using testing_support::allocations;
using testing_support::bytes_of;
using testing_support::own_port;
using testing_support::run_until;

constexpr std::size_t kRounds = 50, kEach = 40;  // more than a batch

// Sends and receives the rounds through the io_context, as a peer does; how many allocations that took.
std::size_t cost_of_rounds(asio::io_context& io, Transport& from, RegionId region, const std::size_t& heard) {
  const std::string text(1200, 'x');
  std::size_t before = 0;
  for (std::size_t round = 0; round < 2 * kRounds; ++round) {
    if (round == kRounds) before = allocations();  // Asio keeps its own operations' memory from the first ones on
    const std::size_t wanted = heard + kEach;
    for (std::size_t i = 0; i < kEach; ++i) from.send(region, bytes_of(text));
    from.flush();
    EXPECT_TRUE(run_until(io, [&] { return heard >= wanted; }));
  }
  return allocations() - before;
}

TEST(Allocations, AreSeen) {
  const std::size_t before = allocations();
  const auto block = std::make_unique<int>(1);
  EXPECT_EQ(allocations(), before + 1) << *block;
}

class MulticastAllocations : public testing::TestWithParam<std::uint32_t> {};
TEST_P(MulticastAllocations, NoneForADatagram) {
  asio::io_context io;
  const MulticastOptions options{.interface = "lo",
                                 .groups = {asio::ip::make_address("239.192.3.0"), own_port(0), GetParam()}};
  auto a = MulticastSocket::open(io, testing_support::clock(), options);
  auto b = MulticastSocket::open(io, testing_support::clock(), options);
  ASSERT_TRUE(a && b);
  for (std::uint32_t region = 0; region < 30; ++region) ASSERT_TRUE((*b)->join(RegionId{region}));  // two sockets
  std::size_t heard = 0;
  (*b)->on_receive([&](const Arrival& arrival) { heard += arrival.datagram.size() == 1200; });
  EXPECT_EQ(cost_of_rounds(io, **a, RegionId{29}, heard), 0u);
  EXPECT_EQ((*b)->counters().packets_in, 2 * kRounds * kEach);
}
INSTANTIATE_TEST_SUITE_P(Pools, MulticastAllocations, testing::Values(0u, 64u));

TEST(UnicastAllocations, NoneForADatagram) {
  asio::io_context io;
  const auto peer = [&](unsigned slot) {
    const asio::ip::udp::endpoint seed(asio::ip::address_v4::loopback(), own_port(1));
    return UnicastFanOut::open(io, testing_support::clock(),
                               {.interface = "lo", .port = own_port(slot), .seeds = {seed}, .key = {slot, 0}});
  };
  auto a = peer(1), b = peer(2);
  ASSERT_TRUE(a && b);
  ASSERT_TRUE((*b)->join(RegionId{7}));
  std::size_t heard = 0;
  (*a)->on_receive([](const Arrival&) {});
  (*b)->on_receive([&](const Arrival& arrival) { heard += arrival.datagram.size() == 1200; });
  const auto told = [&] { return !(*a)->peers().empty() && (*a)->peers().front().regions.size() == 1; };
  ASSERT_TRUE(run_until(io, told));
  // Greetings are lists and do allocate: a round of them may fall into the measurement, a datagram's share may not.
  EXPECT_LT(cost_of_rounds(io, **a, RegionId{7}, heard), kRounds * kEach / 10);
  EXPECT_EQ((*b)->counters().packets_in, 2 * kRounds * kEach);
}

}  // namespace
}  // namespace peerd::net
