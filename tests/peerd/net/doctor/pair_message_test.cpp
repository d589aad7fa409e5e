#include "peerd/net/doctor/pair_message.hpp"

#include <gtest/gtest.h>

#include <random>

namespace peerd::doctor::pair_message_test {

PairMessage full_message() {
  return {.path = Path::kMulticast,
          .session = 0x0123456789abcdef,
          .other = 7,
          .sent = HostTime{Duration{1'700'000'000'000'000'001}},
          .echo_sent = HostTime{Duration{3}},
          .echo_held = Duration{4},
          .in_stream = kStream,
          .tcp_port = 65535,
          .tcp = TcpState::kNoAnswer,
          .complete = true,
          .unicast = {true, 199, 1472},
          .multicast = {false, 200, 1200}};
}

TEST(PairMessage, ComesBackAsItWas) {
  for (const std::size_t size : {kPairMessage_bytes, std::size_t{300}, std::size_t{1472}}) {
    const auto bytes = encode(full_message(), size);
    EXPECT_EQ(bytes.size(), size);
    EXPECT_EQ(decode_pair_message(bytes), full_message());
  }
}

TEST(PairMessage, ACutOneIsNone) {
  const auto bytes = encode(full_message(), kPairMessage_bytes);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(decode_pair_message(std::span(bytes).first(size))) << size;
  }
}

TEST(PairMessage, WhatNoSideSendsIsNone) {
  const auto refused = [](auto change) {
    PairMessage m = full_message();
    change(m);
    return !decode_pair_message(encode(m, kPairMessage_bytes));
  };
  EXPECT_TRUE(refused([](PairMessage& m) { m.session = 0; }));
  EXPECT_TRUE(refused([](PairMessage& m) { m.path = static_cast<Path>(2); }));
  EXPECT_TRUE(refused([](PairMessage& m) { m.tcp = static_cast<TcpState>(4); }));
  EXPECT_TRUE(refused([](PairMessage& m) { m.in_stream = kStream + 1; }));
  EXPECT_TRUE(refused([](PairMessage& m) { m.unicast.stream = kStream + 1; }));
  EXPECT_TRUE(refused([](PairMessage& m) { m.multicast.stream = 65535; }));
  EXPECT_TRUE(refused([](PairMessage& m) { m.echo_held = Duration{-1}; }));
  EXPECT_TRUE(refused([](PairMessage& m) { m.sent = HostTime{Duration::max()}; }));
  EXPECT_TRUE(refused([](PairMessage& m) { m.echo_sent = HostTime{Duration::min()}; }));
  auto other_magic = encode(full_message(), kPairMessage_bytes);
  other_magic[6] = std::byte{2};
  EXPECT_FALSE(decode_pair_message(other_magic)) << "another version";
}

// What is accepted of damaged bytes is what a side could have sent: it says the same when it is written again.
TEST(PairMessage, DamagedBytesAreNoneOrAMessage) {
  std::mt19937 random(38);
  for (int round = 0; round < 20'000; ++round) {
    auto bytes = encode(full_message(), kPairMessage_bytes);
    for (int flips = 0; flips < 3; ++flips)
      bytes[random() % bytes.size()] ^= static_cast<std::byte>(1u << random() % 8);
    const auto message = decode_pair_message(bytes);
    if (message) {
      EXPECT_EQ(decode_pair_message(encode(*message, kPairMessage_bytes)), message);
    }
  }
}

}  // namespace peerd::doctor::pair_message_test
