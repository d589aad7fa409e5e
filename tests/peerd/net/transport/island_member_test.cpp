#include "peerd/net/transport/island_member.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "peerd/net/greeting/unicast_frame.hpp"
#include "tests/net/listener.hpp"

namespace peerd::net::island_member_test {

using testing::ElementsAre;
using testing::IsEmpty;
using testing_support::bytes_of;
using testing_support::clock;
using testing_support::text_of;

constexpr RegionId kAll{0};

// A carrier that keeps what is sent, and receives what the test says.
class Carrier final : public Transport {
 public:
  void on_receive(ReceiveHandler handler) override { handler_ = std::move(handler); }
  bool receive_pending() override { return false; }
  std::expected<void, NetError> join(RegionId) override { return {}; }
  std::expected<void, NetError> leave(RegionId) override { return {}; }
  void send(RegionId region, std::span<const std::byte> datagram) override {
    EXPECT_EQ(region, kAll);
    sent.emplace_back(datagram.begin(), datagram.end());
  }
  void flush() override {}
  [[nodiscard]] std::optional<InterfaceChange> follow_interface() override { return std::nullopt; }
  [[nodiscard]] const TrafficCounters& counters() const override { return counters_; }
  [[nodiscard]] std::size_t joined_count() const override { return 0; }
  [[nodiscard]] int receive_buffer_bytes() const override { return 0; }
  [[nodiscard]] asio::ip::address own_address() const override { return {}; }
  [[nodiscard]] std::string describe() const override { return "carrier"; }

  void arrives(RegionId region, std::span<const std::byte> datagram) {
    ++counters_.packets_in;
    counters_.bytes_in += datagram.size();
    const asio::ip::udp::endpoint from(asio::ip::make_address("192.0.2.1"), 47474);
    handler_({region, datagram, clock().now(), from});
  }
  std::vector<std::vector<std::byte>> sent;

 private:
  ReceiveHandler handler_;
  TrafficCounters counters_;
};

struct IslandMemberTest : testing::Test {
  IslandMemberTest() {
    auto owned = std::make_unique<Carrier>();
    carrier = owned.get();
    member = std::make_unique<IslandMember>(clock(), std::move(owned),
                                            IslandMember::Options{.key = {1, 2}, .group_offset = 2048});
    member->on_receive([this](const Arrival& arrival) { heard.push_back(text_of(arrival.datagram)); });
  }
  void relay_asks() {
    Greeting question{.instance = 9};
    question.link = LinkNote{.sent_at_ns = ++asked, .path = {9}};
    carrier->arrives(kAll, encode(question, true));
  }
  [[nodiscard]] Greeting last_report() const {
    const auto report = decode_greeting(carrier->sent.back(), true);
    EXPECT_TRUE(report && report->link);
    return report.value_or(Greeting{});
  }

  Carrier* carrier = nullptr;
  std::unique_ptr<IslandMember> member;
  std::vector<std::string> heard;
  std::int64_t asked = 0;
};

TEST_F(IslandMemberTest, SaysNothingWithoutARelay) {
  ASSERT_TRUE(member->join(kAll) && member->join(RegionId{7}));
  member->flush();
  carrier->arrives(kAll, bytes_of("\x08 a datagram"));
  EXPECT_THAT(carrier->sent, IsEmpty());
  EXPECT_THAT(heard, ElementsAre("\x08 a datagram"));
}

TEST_F(IslandMemberTest, AnswersARelayAndSaysEachChange) {
  ASSERT_TRUE(member->join(kAll) && member->join(RegionId{7}));
  relay_asks();
  ASSERT_EQ(carrier->sent.size(), 1u);
  EXPECT_THAT(last_report().regions, ElementsAre(kAll, RegionId{7}));
  EXPECT_EQ(last_report().link->group_offset, 2048u);
  EXPECT_THAT(last_report().link->path, IsEmpty());
  relay_asks();  // a moment later: it has been answered
  EXPECT_EQ(carrier->sent.size(), 1u);
  const auto before = last_report().link->sent_at_ns;
  ASSERT_TRUE(member->join(RegionId{9}) && member->leave(RegionId{7}));
  member->flush();
  ASSERT_EQ(carrier->sent.size(), 2u);
  EXPECT_THAT(last_report().regions, ElementsAre(kAll, RegionId{9}));
  EXPECT_GT(last_report().link->sent_at_ns, before);
  EXPECT_THAT(heard, IsEmpty());
}

TEST_F(IslandMemberTest, OtherMembersAndOtherBytesAreNoQuestion) {
  ASSERT_TRUE(member->join(kAll));
  Greeting report{.instance = 8};
  report.link = LinkNote{.sent_at_ns = 1};
  carrier->arrives(kAll, encode(report, true));
  carrier->arrives(kAll, bytes_of("Garbage"));
  EXPECT_THAT(carrier->sent, IsEmpty());
  EXPECT_THAT(heard, IsEmpty());
  EXPECT_EQ(member->counters().in_malformed, 1u);
  EXPECT_EQ(member->counters().greetings_in, 1u);
  EXPECT_EQ(member->counters().packets_in, 0u);
  EXPECT_EQ(member->counters().bytes_in, 0u);
}

// In a region of its own no datagram is taken for a greeting.
TEST_F(IslandMemberTest, GreetingsAreInRegionZeroAlone) {
  carrier->arrives(RegionId{7}, bytes_of("Go on"));
  EXPECT_THAT(heard, ElementsAre("Go on"));
}

}  // namespace peerd::net::island_member_test
