#include "peerd/net/os/udp_receiver.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "peerd/net/os/udp_socket.hpp"
#include "tests/net/listener.hpp"

namespace peerd::net::udp_receiver_test {

using asio::ip::udp;
using testing::ElementsAre;
using testing_support::clock;
using testing_support::run_until;
using testing_support::text_of;

// A receiver and a sender on lo. The receiver's buffer is the smallest that the kernel grants.
struct UdpReceiverTest : testing::Test {
  UdpReceiverTest() {
    receiver.emplace(io, reading);
    EXPECT_TRUE(open_udp(receiver->socket(), {.v4 = true, .dscp = 0, .receive_buffer_bytes = 0}));
    receiver->socket().bind({asio::ip::address_v4::loopback(), 0});
    sender.open(udp::v4());
    sender.connect(receiver->socket().local_endpoint());
  }
  void start() {
    receiver->start([this](const Received& datagram, HostTime at) {
      heard.push_back(text_of(datagram.bytes));
      arrivals.push_back(at);
    });
  }
  void send(const std::string& text) { sender.send(asio::buffer(text)); }
  // More datagrams than the buffer holds. Returns how many were sent.
  std::uint64_t flood() {
    for (int i = 0; i < 200; ++i) send(std::string(100, 'x'));
    return 200;
  }
  void read_all() {
    while (receiver->read()) {
    }
  }

  asio::io_context io;
  TrafficCounters counters;
  Reading reading{clock(), counters, 100};
  std::optional<UdpReceiver> receiver;
  udp::socket sender{io};
  std::vector<std::string> heard;
  std::vector<HostTime> arrivals;
};

TEST_F(UdpReceiverTest, HandsOnWhatWaitsAndSaysWhetherAnythingDid) {
  start();
  EXPECT_FALSE(receiver->read());
  const HostTime before = clock().now();
  send("one");
  send("two");
  EXPECT_TRUE(receiver->read());
  EXPECT_THAT(heard, ElementsAre("one", "two"));
  EXPECT_FALSE(receiver->read());
  ASSERT_EQ(arrivals.size(), 2u);
  EXPECT_GE(arrivals[0], before - ArrivalClock::kRounding);
  EXPECT_LE(arrivals[0], arrivals[1]);
  EXPECT_LE(arrivals[1], clock().now());
  EXPECT_EQ(counters.in_unstamped + counters.in_stamp_refused, 0u);
}

TEST_F(UdpReceiverTest, ReadsByItselfWhenTheContextRuns) {
  start();
  send("one");
  EXPECT_TRUE(run_until(io, [&] { return heard.size() == 1; }));
  send("two");
  EXPECT_TRUE(run_until(io, [&] { return heard.size() == 2; })) << "it goes on waiting";
}

TEST_F(UdpReceiverTest, AReadEndsAfterTwoBatches) {
  receiver->socket().set_option(udp::socket::receive_buffer_size(200'000));
  start();
  for (std::size_t i = 0; i < 2 * kBatch + 1; ++i) send("");
  ASSERT_TRUE(receiver->read());
  EXPECT_EQ(heard.size(), 2 * kBatch);
  EXPECT_TRUE(receiver->read());
  EXPECT_EQ(heard.size(), 2 * kBatch + 1);
}

TEST_F(UdpReceiverTest, CountsWhatTheKernelHadNoRoomFor) {
  start();
  std::uint64_t sent = flood();
  read_all();
  send("after");  // the count comes with the next datagram
  ++sent;
  read_all();
  EXPECT_EQ(heard.back(), "after");
  EXPECT_GT(counters.in_queue_overflow, 0u);
  EXPECT_EQ(heard.size() + counters.in_queue_overflow, sent);
}

TEST_F(UdpReceiverTest, WhatItsFilterDropsIsNoLoss) {
  start();
  std::uint64_t sent = flood();
  for (int i = 0; i < 7; ++i) receiver->on_filtered();
  read_all();
  send("after");
  ++sent;
  read_all();
  EXPECT_EQ(heard.size() + counters.in_queue_overflow + 7, sent);
}

TEST_F(UdpReceiverTest, ADestroyedReceiverIsNotCalledBack) {
  start();
  send("one");
  receiver.reset();
  io.restart();
  io.run_for(std::chrono::milliseconds(20));
  EXPECT_TRUE(heard.empty());
}

TEST_F(UdpReceiverTest, AFailedReadIsCounted) {
  start();
  receiver->socket().close();
  EXPECT_FALSE(receiver->read());
  EXPECT_EQ(counters.in_errors, 1u);
}

}  // namespace peerd::net::udp_receiver_test
