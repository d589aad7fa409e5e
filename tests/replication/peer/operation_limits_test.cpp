#include "replication/peer/operation_limits.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/parts.hpp"

namespace peerd::replication::operation_limits_test {

using namespace test;

class Bounded : public testing::Test {
 protected:
  Bounded() { add_member(members, 2); }

  [[nodiscard]] static OperationPart part(std::uint64_t from, std::size_t size, std::uint32_t author = 77) {
    return {AuthorId{author}, from, std::vector<std::byte>(size)};
  }

  PeerCounters counters;
  Membership members{1750ms};
  Outbox outbox{PeerId{1}, 100, counters};
  MemberLimits member_limits{members, outbox, counters};
  OperationLogs logs{AuthorId{5}};
  OperationLimits limits{logs, members, member_limits};
};

TEST_F(Bounded, ALogEndsAtOneLengthForAll) {
  constexpr std::uint64_t kMax = MemberLimits::kLogMax_bytes;
  EXPECT_TRUE(limits.admit(host(0s), PeerId{2}, part(kMax - 100, 100)));
  EXPECT_FALSE(limits.admit(host(0s), PeerId{2}, part(kMax - 100, 101)));
  EXPECT_FALSE(limits.admit(host(0s), PeerId{2}, part(std::uint64_t{1} << 63, 100)));
  EXPECT_EQ(counters.drops["log_too_long"], 2u);
  EXPECT_TRUE(limits.has_room(AuthorId{77}));
}

TEST_F(Bounded, BytesComeBackWithTime) {
  const LimitRate rate = *rate_of(MemberLimit::kOperations);
  for (double used = 0.0; used < rate.burst; used += 1e6) (void)limits.admit(host(0s), PeerId{2}, part(0, 1'000'000));
  EXPECT_FALSE(limits.admit(host(0s), PeerId{2}, part(0, 1'000'000)));
  EXPECT_TRUE(limits.admit(host(1s), PeerId{2}, part(0, 1'000'000)));
  EXPECT_TRUE(limits.admit(host(0s), PeerId{3}, part(0, 1'000'000))) << "each member has its own";
}

TEST_F(Bounded, OnlyStampsFarAheadAreNamed) {
  limits.note_stamp(host(0s), PeerId{2}, sim(20s), sim(10s));
  EXPECT_EQ(counters.drops["operation_ahead"], 0u);
  limits.note_stamp(host(0s), PeerId{2}, sim(20s) + 1ns, sim(10s));
  EXPECT_EQ(counters.drops["operation_ahead"], 1u);
}

TEST_F(Bounded, NoQuestionIsNone) {
  EXPECT_FALSE(limits.admit(host(0s), PeerId{2}, std::span<const OperationRange>{}));
  EXPECT_TRUE(counters.drops.empty());
}

TEST_F(Bounded, UnknownAuthorsOfThoseWhoAreGoneAreForgotten) {
  const auto name = [&](std::uint32_t peer, std::uint32_t from, std::size_t count) {
    std::vector<LogLength> lengths;
    for (std::uint32_t k = 0; k < count; ++k) lengths.push_back({AuthorId{from + k}, 9});
    return limits.admit(host(0s), PeerId{peer}, lengths).size();
  };
  EXPECT_EQ(name(2, 1000, OperationLimits::kUnknownMax + 5), OperationLimits::kUnknownMax);
  EXPECT_EQ(name(2, 1000, 10), 10u) << "those are named already";
  EXPECT_EQ(name(3, 1000, 10), 10u) << "another member";
}

}  // namespace peerd::replication::operation_limits_test
