#include "peerd/net/greeting/read_greeting.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace peerd::net::read_greeting_test {

// Its seal is one byte more; it opens what begins with that.
class OneByteSeal final : public GreetingSeal {
 public:
  std::vector<std::byte> seal(std::span<const std::byte> greeting) override {
    std::vector<std::byte> sealed{kMark};
    sealed.insert(sealed.end(), greeting.begin(), greeting.end());
    return sealed;
  }
  std::optional<std::vector<std::byte>> open(std::span<const std::byte> sealed, HostTime,
                                             const boost::asio::ip::udp::endpoint&) override {
    if (sealed.empty() || sealed.front() != kMark) return std::nullopt;
    return std::vector<std::byte>(sealed.begin() + 1, sealed.end());
  }
};

struct ReadGreeting : testing::Test {
  std::optional<Greeting> read(std::span<const std::byte> bytes, GreetingSeal* with) {
    return read_greeting(bytes, true, with, now, from, strangers, counters);
  }
  const std::vector<std::byte> greeting = encode({.instance = 5, .number = 6}, true);
  const boost::asio::ip::udp::endpoint from{boost::asio::ip::make_address("192.0.2.1"), 1};
  OneByteSeal seal;
  HostTime now{std::chrono::seconds(1)};
  SourceBuckets strangers{{1, 2}, {}};
  TrafficCounters counters;
};

TEST_F(ReadGreeting, OpensWhatIsSealedAndCountsWhatIsNot) {
  EXPECT_EQ(read(seal.seal(greeting), &seal)->instance, 5u);
  EXPECT_FALSE(read(greeting, &seal));
  EXPECT_EQ(counters.greetings_unopened, 1u);
  EXPECT_EQ(read(greeting, nullptr)->number, 6u);
  EXPECT_FALSE(read(std::span(greeting).first(9), nullptr));
  EXPECT_EQ(counters.in_malformed, 1u);
}

TEST_F(ReadGreeting, StrangersMayNotHaveManyOpened) {
  std::size_t opened = 0;
  for (int i = 0; i < 20'000; ++i) opened += read(seal.seal(greeting), &seal) ? 1 : 0;
  EXPECT_LT(opened, 20'000u);
  EXPECT_EQ(counters.greetings_flood, 20'000u - opened);
}

TEST_F(ReadGreeting, ItsFirstByteTellsItFromADatagram) {
  EXPECT_TRUE(looks_like_greeting(greeting));
  EXPECT_TRUE(looks_like_greeting(seal.seal(greeting)));
  // An open datagram, a sealed and a signed one, an announcement, a part of a roster, headers of regions and relays.
  for (const int first : {0x08, 0x80, 0xA0, 0xC0, 0xE0, 0x52, 0x53}) {
    const std::vector<std::byte> other{static_cast<std::byte>(first)};
    EXPECT_FALSE(looks_like_greeting(other)) << first;
  }
  EXPECT_FALSE(looks_like_greeting({}));
}

}  // namespace peerd::net::read_greeting_test
