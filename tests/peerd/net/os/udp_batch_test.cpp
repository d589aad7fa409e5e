#include "peerd/net/os/udp_batch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>

#include "peerd/net/os/udp_socket.hpp"
#include "tests/must.hpp"
#include "tests/net/listener.hpp"

namespace peerd::net::udp_batch_test {

using asio::ip::udp;
using testing::ElementsAre;
using testing_support::bytes_of;
using testing_support::text_of;

// Two sockets on lo, whose ports the system chooses.
struct UdpBatch : testing::Test {
  UdpBatch() {
    for (udp::socket* socket : {&a, &b}) {
      must(open_udp(*socket, {.v4 = true, .dscp = 0, .receive_buffer_bytes = 1 << 20}));
      socket->bind({asio::ip::address_v4::loopback(), 0});
    }
    to_b = b.local_endpoint();
  }
  std::vector<std::string> read_all() {
    std::vector<std::string> heard;
    for (int count; (count = batch.read(b.native_handle())) > 0;) {
      for (int i = 0; i < count; ++i) heard.push_back(text_of(batch[static_cast<std::size_t>(i)].bytes));
    }
    return heard;
  }

  asio::io_context io;
  udp::socket a{io}, b{io};
  udp::endpoint to_b;
  SendQueue queue{100};
  ReceiveBatch batch{100};
  TrafficCounters counters;
};

TEST_F(UdpBatch, WhatIsPushedArrivesInOrderWithItsHeader) {
  const std::string header = "h:";
  for (int i = 0; i < 5; ++i) queue.push(to_b, bytes_of(i % 2 == 0 ? header : ""), bytes_of(std::to_string(i)));
  queue.flush(a.native_handle(), counters);
  EXPECT_THAT(read_all(), ElementsAre("h:0", "1", "h:2", "3", "h:4"));
  EXPECT_EQ(counters.packets_out, 5u);
  EXPECT_EQ(counters.bytes_out, 11u);
  EXPECT_EQ(counters.calls_out, 1u);
}

TEST_F(UdpBatch, TheKernelSaysWhereFromWhereToAndWhen) {
  queue.push(to_b, {}, bytes_of("x"));
  queue.flush(a.native_handle(), counters);
  ASSERT_EQ(batch.read(b.native_handle()), 1);
  const Received got = batch[0];
  EXPECT_EQ(got.from, a.local_endpoint());
  EXPECT_EQ(got.to, asio::ip::address(asio::ip::address_v4::loopback()));
  EXPECT_EQ(got.interface_index, 1u) << "lo";
  EXPECT_FALSE(got.truncated);
  EXPECT_FALSE(got.lost_before);
  EXPECT_TRUE(got.wall_stamp);
}

TEST_F(UdpBatch, LengthsOfOneReadDoNotCutTheNext) {
  for (const char* text : {"1", "longer than the one before"}) {
    queue.push(to_b, {}, bytes_of(text));
    queue.flush(a.native_handle(), counters);
    ASSERT_EQ(batch.read(b.native_handle()), 1);
    const Received got = batch[0];
    EXPECT_EQ(text_of(got.bytes), text);
    EXPECT_EQ(got.from, a.local_endpoint());
    EXPECT_TRUE(got.wall_stamp && got.to) << text;
  }
}

// The read after a loss has one more control message than the reads before.
TEST_F(UdpBatch, HowManyWereLostIsSaidBesideAllElse) {
  const int small = 4096;
  ASSERT_EQ(set_option(b.native_handle(), SOL_SOCKET, SO_RCVBUF, small), 0);
  const auto send = [&](std::string_view text) {
    queue.push(to_b, {}, bytes_of(text));
    queue.flush(a.native_handle(), counters);
  };
  send("first");
  ASSERT_EQ(batch.read(b.native_handle()), 1);
  constexpr std::size_t kFlood = 200;
  for (std::size_t i = 0; i < kFlood; ++i) send("flood");
  const std::size_t got = read_all().size();
  ASSERT_LT(got, kFlood);
  send("last");
  ASSERT_EQ(batch.read(b.native_handle()), 1);
  const Received last = batch[0];
  EXPECT_EQ(last.lost_before, kFlood - got);
  EXPECT_TRUE(last.to && last.wall_stamp);
}

TEST_F(UdpBatch, WhatIsTooLongSaysSo) {
  a.send_to(asio::buffer(std::string(100, 'x')), to_b);
  a.send_to(asio::buffer(std::string(101, 'y')), to_b);
  ASSERT_EQ(batch.read(b.native_handle()), 2);
  EXPECT_FALSE(batch[0].truncated);
  EXPECT_TRUE(batch[1].truncated);
}

TEST_F(UdpBatch, NothingWaitingIsEagain) { EXPECT_EQ(batch.read(b.native_handle()), -EAGAIN); }

// A datagram that the kernel refuses does not hold up those behind it.
TEST_F(UdpBatch, TheRefusedAreCountedAndTheOthersLeave) {
  const udp::endpoint nowhere(asio::ip::address_v4::loopback(), 0);        // EINVAL
  const udp::endpoint forbidden(asio::ip::address_v4::broadcast(), 4000);  // EACCES: no SO_BROADCAST
  for (const auto& to : {to_b, nowhere, to_b, forbidden, forbidden, to_b, nowhere}) queue.push(to, {}, bytes_of("x"));
  queue.flush(a.native_handle(), counters);
  EXPECT_EQ(read_all().size(), 3u);
  EXPECT_EQ(counters.packets_out, 3u);
  EXPECT_EQ(counters.out_errors, 2u);
  EXPECT_EQ(counters.out_blocked, 2u);
  queue.push(to_b, {}, bytes_of("next"));
  queue.flush(a.native_handle(), counters);
  EXPECT_THAT(read_all(), ElementsAre("next")) << "nothing of the last batch is sent again";
}

}  // namespace peerd::net::udp_batch_test
