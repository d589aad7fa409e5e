#include "replication/edits/scene/known_operations.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <set>

namespace peerd::replication::known_operations_test {

constexpr AuthorId kAda{7}, kBob{9}, kCid{11};

Operation operation(OperationId id, std::vector<OperationId> knows) {
  return {id, SimTime{}, RemoveObject{ObjectId{0}}, std::move(knows)};
}

TEST(KnownOperations, NobodyUnlearns) {
  KnownOperations known;
  known.add(operation({kAda, 1}, {{kBob, 5}}));
  known.add(operation({kAda, 2}, {{kBob, 3}}));
  EXPECT_TRUE(known.knew({kAda, 2}, {kBob, 5}));
  EXPECT_FALSE(known.knew({kAda, 2}, {kBob, 6}));
}

// Three authors, of whom each holds a beginning of each log, against sets of all that each held.
TEST(KnownOperations, AsSetsOfAllThatEachHeld) {
  std::mt19937_64 random(1);
  const std::array authors{kAda, kBob, kCid};
  KnownOperations all;
  std::array<KnownOperations, 3> own;
  std::array<std::array<std::uint32_t, 3>, 3> holds{};
  std::vector<Operation> made;
  std::set<std::pair<OperationId, OperationId>> knew;
  std::array<std::vector<Operation>, 3> logs;
  for (int k = 0; k < 900; ++k) {
    const std::size_t i = random() % 3, j = random() % 3;
    if (random() % 2 == 0) {
      if (i == j || holds[i][j] == logs[j].size()) continue;
      own[i].add(logs[j][holds[i][j]++]);
      continue;
    }
    const OperationId id{authors[i], static_cast<std::uint32_t>(logs[i].size() + 1)};
    for (std::size_t other = 0; other < 3; ++other) {
      for (std::uint32_t n = 1; n <= holds[i][other]; ++n) knew.insert({id, {authors[other], n}});
    }
    const Operation o = operation(id, own[i].news_for(authors[i]));
    own[i].add(o);
    all.add(o);
    logs[i].push_back(o);
    ++holds[i][i];
    made.push_back(o);
  }
  std::size_t known = 0;
  for (const Operation& a : made) {
    for (const Operation& b : made) {
      const bool expected = knew.contains({a.id, b.id});
      known += expected ? 1 : 0;
      EXPECT_EQ(all.knew(a.id, b.id), expected);
    }
  }
  EXPECT_GT(known, 1000u);
  EXPECT_GT(made.size() * made.size() - known, 1000u);
}

}  // namespace peerd::replication::known_operations_test
