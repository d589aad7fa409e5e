// Growth that waits for the store stays small in count, and whole.
#include "peerd/peer/store/unstored_growth.hpp"

#include <gtest/gtest.h>

#include <array>

#include "peerd/peer/motion/random.hpp"

namespace peerd::store::unstored_growth_test {

using replication::AuthorId;

class Unstored : public testing::Test {
 protected:
  void grow(AuthorId author, std::uint64_t bytes) {
    Log& log = logs[author.value];
    unstored.add({{author, log.bytes, log.bytes + bytes}, {author, ++log.number}});
    log.bytes += bytes;
  }
  struct Log {
    std::uint64_t bytes = 0;
    std::uint32_t number = 0;
  };
  std::array<Log, 4> logs{};
  UnstoredGrowth unstored;
};

TEST_F(Unstored, OperationsOfOneAuthorAreOneEntry) {
  for (int i = 0; i < 10'000; ++i) grow(AuthorId{1 + static_cast<std::uint32_t>(i % 3)}, 40);
  EXPECT_EQ(unstored.count(), 3U);
  EXPECT_EQ(unstored.bytes(), 400'000U);
  const auto batch = unstored.next_batch();
  ASSERT_EQ(batch.size(), 3U);
  EXPECT_EQ(batch[0].range, (replication::OperationRange{AuthorId{1}, 0, 3'334 * 40}));
  EXPECT_EQ(batch[0].last, (replication::OperationId{AuthorId{1}, 3'334}));
}

// Whatever comes while it is stored in batches: each log is stored without a gap, up to its end, and no entry is larger
// than it may be.
TEST_F(Unstored, AllIsStoredInItsOrder) {
  motion::Random random(1, 0);
  std::array<Log, 4> stored{};
  std::uint64_t total = 0, most = 0;
  for (int round = 0; round < 400; ++round) {
    for (std::uint64_t more = random.below(200); more > 0; --more) {
      const AuthorId author{1 + static_cast<std::uint32_t>(random.below(3))};
      const std::uint64_t bytes = 1 + random.below(60'000);
      grow(author, bytes);
      total += bytes;
    }
    most = std::max<std::uint64_t>(most, unstored.count());
    EXPECT_LE(unstored.count(), 3 + 2 * unstored.bytes() / UnstoredGrowth::kGrowthMax_bytes + 1);
    while (!unstored.empty() && random.chance(0.6)) {
      const auto batch = unstored.next_batch();
      std::uint64_t bytes = 0;
      for (const auto& growth : batch) {
        Log& log = stored[growth.range.author.value];
        ASSERT_EQ(growth.range.from, log.bytes);
        ASSERT_LE(growth.range.to - growth.range.from, UnstoredGrowth::kGrowthMax_bytes);
        ASSERT_GT(growth.last.number, log.number);
        log = {growth.range.to, growth.last.number};
        bytes += growth.range.to - growth.range.from;
      }
      ASSERT_LE(bytes, UnstoredGrowth::kBatchMax_bytes);
      total -= bytes;
      unstored.drop(batch.size());
      ASSERT_EQ(unstored.bytes(), total);
    }
  }
  while (!unstored.empty()) {
    const auto batch = unstored.next_batch();
    for (const auto& growth : batch) stored[growth.range.author.value] = {growth.range.to, growth.last.number};
    unstored.drop(batch.size());
  }
  EXPECT_GT(most, 10U);
  for (std::size_t author = 1; author < logs.size(); ++author) {
    EXPECT_EQ(stored[author].bytes, logs[author].bytes);
    EXPECT_EQ(stored[author].number, logs[author].number);
  }
}

TEST_F(Unstored, WhatIsLargerThanAnEntryIsOneByItself) {
  grow(AuthorId{1}, 3 * UnstoredGrowth::kBatchMax_bytes);
  grow(AuthorId{1}, 10);
  EXPECT_EQ(unstored.count(), 2U);
  EXPECT_EQ(unstored.next_batch().size(), 1U) << "it must be stored somehow";
}

}  // namespace peerd::store::unstored_growth_test
