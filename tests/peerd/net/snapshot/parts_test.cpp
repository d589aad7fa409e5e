#include "peerd/net/snapshot/parts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "peerd/net/snapshot/snapshot_message.hpp"

namespace peerd::snapshot::parts_test {

using replication::AuthorId;
using replication::kNoAuthor;
using replication::OperationRange;

constexpr AuthorId kAuthor{5};
const std::map<AuthorId, std::uint64_t> kAll{{kNoAuthor, 1'000'000}, {kAuthor, 1'000'000}};

// Asks for the next part over a new connection.
std::optional<OperationRange> next(Parts& parts) {
  std::set<OperationRange> asked;
  return parts.next(kAll, asked);
}
// Gives all that is not awaited yet, as that peer and of that letter.
void give_all(Parts& parts, std::size_t peer, char letter) {
  while (!parts.are_there()) {
    const OperationRange part = next(parts).value();
    EXPECT_TRUE(parts.take(part, std::string(part.to - part.from, letter), peer));
  }
}

TEST(SnapshotParts, AreGotOnceEach) {
  Parts parts;
  parts.plan(kPartMax_bytes + 10, {{kAuthor, 5}});
  EXPECT_EQ(next(parts), (OperationRange{kNoAuthor, 0, kPartMax_bytes}));
  EXPECT_EQ(next(parts), (OperationRange{kNoAuthor, kPartMax_bytes, kPartMax_bytes + 10}));
  EXPECT_EQ(next(parts), (OperationRange{kAuthor, 0, 5}));
  EXPECT_EQ(next(parts), (OperationRange{kNoAuthor, 0, kPartMax_bytes})) << "over a second connection";
  EXPECT_FALSE(parts.are_there());
}

TEST(SnapshotParts, WhatOnePeerGaveIsGotAgain) {
  Parts parts;
  parts.plan(10, {{kAuthor, 20}});
  EXPECT_TRUE(parts.take(next(parts).value(), std::string(10, 'a'), 1));
  EXPECT_TRUE(parts.take(next(parts).value(), std::string(20, 'b'), 2));
  EXPECT_EQ(parts.given_bytes(2), 20u);
  parts.drop(2);
  parts.plan(10, {{kAuthor, 20}});
  EXPECT_EQ(parts.given_bytes(2), 0u);
  EXPECT_THAT(parts.givers(kAuthor), testing::IsEmpty());
  give_all(parts, 3, 'c');
  EXPECT_EQ(parts.content(kNoAuthor), std::string(10, 'a'));
  EXPECT_EQ(parts.content(kAuthor), std::string(20, 'c'));
  EXPECT_THAT(parts.givers(kAuthor), testing::ElementsAre(3));
}

TEST(SnapshotParts, AnotherPlanKeepsWhatBothHave) {
  Parts parts;
  parts.plan(10, {{kAuthor, 2 * kPartMax_bytes}});
  give_all(parts, 1, 'a');
  parts.plan(10, {{kAuthor, kPartMax_bytes + 5}});
  EXPECT_FALSE(parts.are_there());
  EXPECT_EQ(next(parts), (OperationRange{kAuthor, kPartMax_bytes, kPartMax_bytes + 5}));
  EXPECT_TRUE(parts.take({kAuthor, kPartMax_bytes, kPartMax_bytes + 5}, "bbbbb", 2));
  EXPECT_EQ(parts.content(kAuthor), std::string(kPartMax_bytes, 'a') + "bbbbb");
}

TEST(SnapshotParts, AnArchiveThatIsWrongIsGotAgain) {
  Parts parts;
  parts.plan(kPartMax_bytes + 10, {});
  give_all(parts, 1, 'a');
  EXPECT_EQ(parts.content(kNoAuthor).size(), kPartMax_bytes + 10);
  parts.drop_archive();
  parts.drop(1);
  parts.plan(kPartMax_bytes + 10, {});
  give_all(parts, 2, 'b');
  EXPECT_EQ(parts.content(kNoAuthor), std::string(kPartMax_bytes + 10, 'b'));
}

}  // namespace peerd::snapshot::parts_test
