// Sealed transports over multicast on lo.
#include "peerd/net/seal/sealed_transport.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "tests/net/listener.hpp"

namespace peerd::seal::sealed_transport_test {

namespace asio = boost::asio;
using net::testing_support::bytes_of;
using net::testing_support::clock;
using net::testing_support::Listener;
using net::testing_support::own_port;
using net::testing_support::run_until;
using net::testing_support::text_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

net::MulticastOptions options() {
  return {.interface = "lo", .groups = {asio::ip::make_address("239.192.81.0"), own_port(12)}};
}

// A peer that keeps what it hears, and what a person was told.
struct Speaker {
  Speaker(asio::io_context& io, const keys::SymmetricKey& key, std::uint32_t number)
      : id(number),
        transport(io, clock(), net::MulticastSocket::open(io, clock(), options()).value(), key,
                  {.peer = PeerId{number}, .identity = keys::Identity::random()}, contents_of,
                  [this](const std::string& line) { warnings.push_back(line); }) {
    EXPECT_TRUE(transport.join(RegionId{0}));
    transport.on_receive([this](const net::Arrival& arrival) {
      heard.push_back(text_of(arrival.datagram).substr(2));
      ++passed_on;
    });
  }
  // Says it as the peer of that number, this one by default; `how`: '!' is what must be signed.
  void say(std::string_view text, char how = '!', std::optional<std::uint32_t> as = {}) {
    const std::string datagram = std::string{how, static_cast<char>('0' + as.value_or(id))} + std::string(text);
    transport.send(RegionId{0}, bytes_of(datagram));
    transport.flush();
  }
  static std::optional<Contents> contents_of(std::span<const std::byte> datagram) {
    const std::string text = text_of(datagram);
    if (text.size() < 2) return std::nullopt;
    return Contents{PeerId{static_cast<std::uint32_t>(text[1] - '0')}, text[0] == '!'};
  }
  std::uint32_t id;
  std::vector<std::string> heard, warnings;
  std::size_t passed_on = 0;
  SealedTransport transport;
};

class SealedTransports : public testing::Test {
 protected:
  // Waits until the two are proven to each other.
  void meet(Speaker& one, Speaker& other) {
    ASSERT_TRUE(run_until(io, [&] {
      one.say("");
      other.say("");
      return !one.heard.empty() && !other.heard.empty();
    }));
    one.heard.clear();
    other.heard.clear();
  }
  asio::io_context io{1};
  const keys::SymmetricKey key = keys::SymmetricKey::random();
};

TEST_F(SealedTransports, CarryDatagrams) {
  Speaker a(io, key, 1), b(io, key, 2);
  meet(a, b);
  a.say("by a");
  ASSERT_TRUE(run_until(io, [&] { return !b.heard.empty() && b.heard.back() == "by a"; }));
  EXPECT_THAT(a.transport.describe(), testing::EndsWith(", sealed"));
  EXPECT_THAT(a.warnings, IsEmpty());
  EXPECT_THAT(b.warnings, IsEmpty());
  EXPECT_GT(a.transport.counters().in_own, 0u) << "multicast comes back to its sender";
  EXPECT_GT(a.transport.counters().announcements_in, 0u);
}

TEST_F(SealedTransports, CountAndNameWhoeverHasAnotherKeyOrNone) {
  Speaker a(io, key, 1), b(io, key, 2), c(io, keys::SymmetricKey::random(), 2);
  Listener open(io, options());
  meet(a, b);
  for (int i = 0; i < 3; ++i) {
    open.send(0, "\x08\x09 open");
    c.say("of another key");
  }
  b.say("the end");
  ASSERT_TRUE(run_until(io, [&] { return !a.heard.empty() && a.heard.back() == "the end"; }));
  EXPECT_THAT(c.heard, IsEmpty());
  const net::TrafficCounters& counters = a.transport.counters();
  EXPECT_EQ(counters.in_open, 3u);
  EXPECT_GE(counters.in_forged, 3u);
  EXPECT_EQ(counters.packets_in, a.passed_on) << "the rest is counted as dropped";
  EXPECT_THAT(a.warnings, testing::UnorderedElementsAre(HasSubstr("sends datagrams that are not sealed"),
                                                        HasSubstr("this peer's key does not open")))
      << "one line of each kind";
}

TEST_F(SealedTransports, CountAndNameWhoeverSpeaksForAnother) {
  Speaker a(io, key, 1), b(io, key, 2);
  meet(a, b);
  b.say("by a", '!', 1);
  b.say("by a", '.', 1);
  b.say("the end", '.');
  ASSERT_TRUE(run_until(io, [&] { return !a.heard.empty() && a.heard.back() == "the end"; }));
  EXPECT_THAT(a.heard, testing::Not(testing::Contains("by a")));
  EXPECT_EQ(a.transport.counters().in_wrong_sender, 2u);
  EXPECT_THAT(a.warnings, ElementsAre(HasSubstr("say another sender than they are sealed by")));
}

// Checking all that one member signs would take half a processor.
TEST_F(SealedTransports, AFloodOfSignedDatagramsDelaysItsSenderAlone) {
  Speaker a(io, key, 1), b(io, key, 2), c(io, key, 3);
  meet(a, b);
  meet(a, c);
  const std::size_t passed_on = a.passed_on;
  const auto begin = std::chrono::steady_clock::now();
  // Each burst waits in the socket before it is read, so that it comes at once on a slow computer, too.
  for (int burst = 0; burst < 5; ++burst) {
    for (int i = 0; i < 600; ++i) b.say(std::to_string(i));
    for (int turn = 0; turn < 100; ++turn) io.poll();
  }
  c.say("by c");
  ASSERT_TRUE(run_until(io, [&] { return !a.heard.empty() && testing::Value(a.heard, testing::Contains("by c")); }));
  // A computer that needs longer than its share for a check loses nothing.
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  EXPECT_LE(static_cast<double>(a.passed_on - passed_on),
            CheckQueue::kRate.most + CheckQueue::kRate.per_second * took.count() + 1.0);
  b.say("the end");
  ASSERT_TRUE(run_until(io, [&] { return testing::Value(a.heard, testing::Contains("the end")); })) << "it goes on";
  EXPECT_EQ(a.transport.counters().packets_in, a.passed_on);
}

// A member signs an announcement wrongly and sends it over and over.
TEST_F(SealedTransports, OneWrongSignatureIsCheckedOnce) {
  Speaker a(io, key, 1), b(io, key, 2);
  Listener raw(io, options());
  meet(a, b);
  const auto somebody = keys::Identity::random(), another = keys::Identity::random();
  const auto wrong =
      seal_announcement({.sender = PeerId{3}, .boot = Sealer::random_boot(), .number = 1, .key = somebody.public_key()},
                        0xC0, announcing_key(key), another);
  constexpr std::uint64_t kTimes = 1000;  // many more than may be checked of one that is new
  for (std::uint64_t i = 0; i < kTimes; ++i) {
    raw.send(0, text_of(wrong));
    if (i % 50 == 0) io.poll();
  }
  b.say("the end");
  ASSERT_TRUE(run_until(io, [&] { return testing::Value(a.heard, testing::Contains("the end")); }));
  EXPECT_EQ(a.transport.counters().in_unsigned, kTimes);
  EXPECT_EQ(a.transport.counters().in_flood, 0u) << "nothing else waits for it";
}

// A flood costs what strangers may cost. One of datagrams leaves the announcements of a joining peer at the same
// address.
TEST_F(SealedTransports, AFloodOfAStrangerIsNotOpened) {
  Speaker a(io, key, 1);
  Listener forger(io, options());
  const std::string announcement(1 + 4 + 24 + 24 + 16, static_cast<char>(0xC0)), datagram(40, static_cast<char>(0x80));
  const auto flood = [&](const std::string& bytes) {
    for (int i = 0; i < 40; ++i) forger.send(0, bytes);
    a.transport.receive_pending();
  };
  for (const std::string& bytes : {announcement, datagram}) {
    const std::uint64_t before = a.transport.counters().in_flood;
    ASSERT_TRUE(run_until(io, [&] {
      for (int i = 0; i < 50; ++i) flood(bytes);
      return a.transport.counters().in_flood > before + 1'000;
    }));
  }
  EXPECT_GE(a.transport.counters().in_forged, 1'000u);
  EXPECT_EQ(a.transport.counters().packets_in, a.passed_on);
  Speaker b(io, key, 2);
  ASSERT_TRUE(run_until(io, [&] {
    flood(datagram);
    b.say("");
    return !a.heard.empty();
  }));
}

}  // namespace peerd::seal::sealed_transport_test
