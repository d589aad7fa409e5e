// In steady state neither sending nor receiving a datagram allocates.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/scene/reader.hpp"
#include "peerd/net/transport/unicast_fan_out.hpp"
#include "replication/peer/peer.hpp"
#include "replication/wire/codec.hpp"
#include "tests/net/allocation_meter.hpp"
#include "tests/net/listener.hpp"

namespace peerd::net::allocation_test {

using testing_support::allocations;
using testing_support::bytes_of;
using testing_support::own_port;
using testing_support::run_until;

constexpr std::size_t kRounds = 50, kEach = 40;  // more than a batch

// Sends and receives all rounds through the io_context, as a peer does, and returns the number of allocations.
std::size_t cost_of_rounds(asio::io_context& io, Transport& from, RegionId region, const std::size_t& heard) {
  const std::string text(1200, 'x');
  std::size_t before = 0;
  for (std::size_t round = 0; round < 2 * kRounds; ++round) {
    if (round == kRounds) before = allocations();  // Asio reuses the memory of its first operations
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
  const auto subscribed = [&] { return !(*a)->peers().empty() && (*a)->peers().front().regions.size() == 1; };
  ASSERT_TRUE(run_until(io, subscribed));
  // Greetings are lists and allocate. One round of them may fall into the measurement; an allocation for each datagram
  // may not.
  EXPECT_LT(cost_of_rounds(io, **a, RegionId{7}, heard), kRounds * kEach / 10);
  EXPECT_EQ((*b)->counters().packets_in, 2 * kRounds * kEach);
}

// Two peers with thirty objects each, which swing so far that updates of each are due several times a second.
class PeerAllocations : public testing::Test {
 protected:
  struct Flight {
    HostTime at;
    std::size_t to;
    replication::Bytes datagram;
  };
  struct Count {
    std::size_t datagrams = 0, allocations = 0;
  };
  static constexpr std::uint32_t kObjects = 30;

  PeerAllocations() {
    std::string text = "#VRML V2.0 utf8\n";
    for (std::uint32_t i = 0; i < 2 * kObjects; ++i) text += "DEF O" + std::to_string(i) + " Transform { }\n";
    ReadResult read = read_world(text);
    scene_ = std::move(read.scene.value());
    model_ = replication::make_world_model(scene_);
    const std::uint32_t first = scene_.find("O0").value().number;
    for (std::uint32_t peer : {0u, 1u}) {
      replication::PeerConfig config;
      config.id = PeerId{1 + peer};
      config.name = "peer" + std::to_string(config.id.value);
      for (std::uint32_t i = 0; i < kObjects; ++i) {
        config.owned.push_back({ObjectId{first + peer * kObjects + i}, true, {}});
        samples_[peer].push_back({config.owned.back().object, {}, true});
      }
      peers_.push_back(std::make_unique<replication::Peer>(std::move(config), *model_));
    }
  }

  // Counts the allocations of datagrams of updates: of received ones, and of ticks that send nothing else.
  void run(Duration until, Count& in, Count& out) {
    const HostTime end{until};
    while (now_ < end) {
      now_ = std::min({end, std::max(now_, peers_[0]->next_deadline()), std::max(now_, peers_[1]->next_deadline()),
                       flights_.empty() ? end : std::max(now_, flights_.front().at)});
      for (; !flights_.empty() && flights_.front().at <= now_; flights_.pop_front()) {
        const Flight& f = flights_.front();
        const std::size_t before = allocations();
        (void)peers_[f.to]->on_packet(now_, replication::kWholeScene, f.datagram);
        const std::size_t cost = allocations() - before;
        drain(f.to);
        if (is_of_updates(f.datagram)) ++in.datagrams, in.allocations += cost;
      }
      for (const std::size_t i : {0u, 1u}) {
        if (peers_[i]->next_deadline() <= now_) tick(i, out);
      }
    }
  }

 private:
  void tick(std::size_t i, Count& out) {
    replication::Peer& peer = *peers_[i];
    const auto due = peer.due_tick(now_);
    if (due) {
      for (std::size_t k = 0; k < kObjects; ++k) {
        const double w = 6.283185307179586, a = w * to_seconds(due->time_since_epoch()) + static_cast<double>(k);
        KinematicState& s = samples_[i][k].state;
        s.position.x() = 3.0 * std::sin(a);
        s.velocity.x() = 3.0 * w * std::cos(a);
        s.acceleration.x() = -3.0 * w * w * std::sin(a);
      }
    }
    const std::size_t before = allocations();
    peer.on_tick(
        now_, due ? std::span<const replication::OwnSample>(samples_[i]) : std::span<const replication::OwnSample>());
    const std::size_t cost = allocations() - before;
    const std::size_t sent = drain(i);
    if (sent > 0) out.datagrams += sent, out.allocations += cost;
  }
  // The number of datagrams of updates; none where another datagram was sent.
  std::size_t drain(std::size_t i) {
    std::size_t sent = 0;
    bool others = false;
    while (auto out = peers_[i]->poll_output()) {
      auto* send = std::get_if<replication::Send>(&*out);
      if (send == nullptr) continue;
      flights_.push_back({now_ + std::chrono::milliseconds(20), 1 - i, send->datagram});
      others = others || !is_of_updates(send->datagram);
      ++sent;
      peers_[i]->reuse(std::move(send->datagram));
    }
    return others ? 0 : sent;
  }
  static bool is_of_updates(std::span<const std::byte> datagram) {
    const auto m = replication::decode(datagram, SimTime{});
    return m && !m->hello && !m->updates.empty();
  }

  Scene scene_;
  std::unique_ptr<const replication::WorldModel> model_;
  std::vector<std::unique_ptr<replication::Peer>> peers_;
  std::array<std::vector<replication::OwnSample>, 2> samples_;
  std::deque<Flight> flights_;
  HostTime now_{Duration{0}};
};

TEST_F(PeerAllocations, NoneForADatagramOfUpdates) {
  Count in, out;
  run(std::chrono::seconds(60), in, out);
  in = out = {};
  run(std::chrono::seconds(80), in, out);
  EXPECT_GT(in.datagrams, 1000u);
  EXPECT_GT(out.datagrams, 1000u);
  EXPECT_EQ(in.allocations, 0u);
  EXPECT_EQ(out.allocations, 0u);
}

}  // namespace peerd::net::allocation_test
