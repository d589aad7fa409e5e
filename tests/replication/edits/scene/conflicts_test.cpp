#include "replication/edits/scene/conflicts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

namespace peerd::replication::conflicts_test {

using testing::IsEmpty;
using testing::SizeIs;

constexpr AuthorId kAda{7}, kBob{9};

OperationKey key(AuthorId author, std::uint32_t number) {
  return {SimTime{Duration{2 * std::int64_t{number} + (author == kBob ? 1 : 0)}}, {author, number}};
}
SimTime at_h(int hours) { return SimTime{std::chrono::hours(hours)}; }

// The two authors write one register each, again and again, and never know of each other.
class BoundedConflicts : public testing::Test {
 protected:
  void write(AuthorId author, std::uint32_t number, std::uint32_t node) {
    bodies[key(author, number)] = SetData{NodeId{node}, "k", "v"};
    conflicts.on_in_force(key(author, number), 0, {}, true);
  }
  std::map<OperationKey, OperationBody> bodies;
  std::set<OperationKey> withdrawn;
  Conflicts conflicts{[this](const OperationKey& each) { return !withdrawn.contains(each); },
                      [this](const OperationKey& each) { return bodies.at(each); }};
};

TEST_F(BoundedConflicts, TheOldestAreForgottenAndCounted) {
  constexpr std::uint32_t kMany = 5000;
  for (std::uint32_t n = 1; n <= kMany; ++n) {
    write(kAda, n, n);
    write(kBob, n, n);
    conflicts.find(SimTime{std::chrono::seconds(n)});
  }
  const auto all = conflicts.list(at_h(2));
  ASSERT_THAT(all, SizeIs(Conflicts::kMax));
  EXPECT_EQ(all.front().loser, key(kAda, kMany - Conflicts::kMax + 1));
  EXPECT_EQ(all.back().loser, key(kAda, kMany));
  EXPECT_EQ(all.back().winner, key(kBob, kMany));
  EXPECT_EQ(conflicts.forgotten(), kMany - Conflicts::kMax);
}

TEST_F(BoundedConflicts, WhatIsOlderThanADayMakesRoomUncounted) {
  for (std::uint32_t n = 1; n <= Conflicts::kMax; ++n) {
    write(kAda, n, n);
    write(kBob, n, n);
  }
  conflicts.find(at_h(1));
  EXPECT_THAT(conflicts.list(at_h(25)), SizeIs(Conflicts::kMax));
  EXPECT_THAT(conflicts.list(at_h(26)), IsEmpty());
  write(kAda, 9000, 9000);
  write(kBob, 9000, 9000);
  conflicts.find(at_h(30));
  EXPECT_THAT(conflicts.list(at_h(30)), SizeIs(1));
  EXPECT_EQ(conflicts.forgotten(), 0u);
}

TEST_F(BoundedConflicts, OnlyWhatIsInForceCounts) {
  write(kAda, 1, 1);
  write(kBob, 1, 1);
  withdrawn.insert(key(kBob, 1));
  conflicts.find(at_h(1));
  EXPECT_THAT(conflicts.list(at_h(1)), IsEmpty());
  withdrawn.clear();
  write(kAda, 2, 1);
  conflicts.find(at_h(1));
  const auto all = conflicts.list(at_h(1));
  ASSERT_THAT(all, SizeIs(1)) << "Ada has gone on from her own";
  EXPECT_EQ(all[0].loser, key(kBob, 1));
  EXPECT_EQ(all[0].winner, key(kAda, 2));
  withdrawn.insert(key(kAda, 2));
  conflicts.on_undone(key(kAda, 2));
  conflicts.find(at_h(1));
  const auto without = conflicts.list(at_h(1));
  ASSERT_THAT(without, SizeIs(1)) << "she has not gone on from it";
  EXPECT_EQ(without[0].loser, key(kAda, 1));
  EXPECT_EQ(without[0].winner, key(kBob, 1));
}

}  // namespace peerd::replication::conflicts_test
