#include "replication/edits/log/member_logs.hpp"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace peerd::replication::member_logs_test {

constexpr AuthorId kOne{1}, kTwo{2};

TEST(MemberLogs, KnowWhoHoldsHowMuch) {
  MemberLogs members;
  EXPECT_TRUE(members.empty());
  for (std::uint32_t peer = 1; peer <= 3; ++peer) members.on_joined(PeerId{peer});
  EXPECT_EQ(members.silent(), 3u);
  const std::vector<LogLength> first{{kOne, 10}, {kTwo, 5}};
  members.on_lengths(PeerId{1}, first);
  members.on_lengths(PeerId{2}, {});
  members.at_least(PeerId{3}, {kOne, 12});
  members.at_least(PeerId{3}, {kOne, 11});
  EXPECT_EQ(members.silent(), 1u);
  EXPECT_EQ(members.longest(kOne), 12u);
  EXPECT_EQ(members.longest(kTwo), 5u);
  EXPECT_EQ(members.lacking({kOne, 10}), 1u);
  EXPECT_EQ(members.lacking({kOne, 11}), 2u);
  members.on_lost(PeerId{3});
  EXPECT_EQ(members.longest(kOne), 10u);
  members.on_joined(PeerId{1});
  EXPECT_EQ(members.longest(kOne), 0u) << "it begins anew";
  EXPECT_EQ(members.size(), 2u);
}

// All holders agree on their order, and blocks have different ones.
TEST(MemberLogs, HoldersHaveRanks) {
  constexpr std::uint32_t kPeers = 10;
  std::set<PeerId> firsts;
  for (std::uint64_t block = 0; block < 100; ++block) {
    const OperationRange range{kOne, block * 100, block * 100 + 50};
    const LogLength log{kOne, range.to}, shorter{kOne, range.to - 1};
    std::set<std::size_t> ranks;
    for (std::uint32_t self = 1; self <= kPeers; ++self) {
      MemberLogs members;
      for (std::uint32_t peer = 1; peer <= kPeers + 5; ++peer) {
        if (peer == self) continue;
        members.on_joined(PeerId{peer});
        members.on_lengths(PeerId{peer}, {peer <= kPeers ? &log : &shorter, 1});
      }
      const std::size_t rank = members.rank(PeerId{self}, range, block);
      EXPECT_TRUE(ranks.insert(rank).second);
      if (rank == 0) firsts.insert(PeerId{self});
    }
    EXPECT_EQ(*ranks.rbegin(), kPeers - 1);
  }
  EXPECT_EQ(firsts.size(), kPeers);
}

// A far peer of a large session says in its hellos what it holds, too.
TEST(MemberLogs, KeepNothingOfWhoIsNoMember) {
  MemberLogs members;
  members.on_lengths(PeerId{1}, std::vector{LogLength{kOne, 10}});
  EXPECT_TRUE(members.empty());
}

TEST(MemberLogs, AreLimited) {
  MemberLogs members;
  for (std::uint32_t i = 1; i <= MemberLogs::kAuthorsMax + 100; ++i) members.at_least(PeerId{1}, {AuthorId{i}, 1});
  EXPECT_EQ(members.ignored(), 100u);
  EXPECT_EQ(members.longest(AuthorId{MemberLogs::kAuthorsMax + 1}), 0u);
}

}  // namespace peerd::replication::member_logs_test
