#include "replication/peer/early_records.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::early_records_test {

using namespace test;

EarlyRecord update(Duration at, std::uint32_t number) { return {sim(at), PeerId{7}, 100, number, UpdateRecord{}}; }
EarlyRecord decision(Duration at, std::uint32_t number) { return {sim(at), PeerId{7}, 100, number, DecisionRecord{}}; }

std::vector<std::uint32_t> numbers_until(EarlyRecords& records, Duration t) {
  std::vector<std::uint32_t> numbers;
  while (const auto record = records.take_until(sim(t))) numbers.push_back(record->number);
  return numbers;
}

TEST(EarlyRecords, LeaveByTheirInstantsThenKindsThenArrivals) {
  EarlyRecords records;
  EXPECT_TRUE(records.add(decision(2s, 1)));
  EXPECT_TRUE(records.add(update(2s, 2)));
  EXPECT_TRUE(records.add(update(1s, 3)));
  EXPECT_TRUE(records.add(update(2s, 4)));
  EXPECT_TRUE(records.add(update(3s, 5)));
  EXPECT_EQ(numbers_until(records, 999ms), (std::vector<std::uint32_t>{}));
  EXPECT_EQ(numbers_until(records, 2s), (std::vector<std::uint32_t>{3, 2, 4, 1}));
  EXPECT_EQ(numbers_until(records, 10s), (std::vector<std::uint32_t>{5}));
}

TEST(EarlyRecords, AreLimitedForEachSender) {
  EarlyRecords records;
  for (std::size_t k = 0; k < EarlyRecords::kOfSenderMax; ++k) ASSERT_TRUE(records.add(update(1s, 1)));
  EXPECT_FALSE(records.add(update(1s, 2)));
  EarlyRecord another = update(1s, 2);
  another.sender = PeerId{8};
  EXPECT_TRUE(records.add(another));
  EXPECT_TRUE(records.take_until(sim(1s)).has_value());
  EXPECT_TRUE(records.add(update(1s, 2)));
}

TEST(EarlyRecords, AreLimitedForAllSenders) {
  EarlyRecords records;
  for (std::size_t k = 0; k < EarlyRecords::kOfAllMax; ++k) {
    EarlyRecord record = update(1s, 1);
    record.sender = PeerId{static_cast<std::uint32_t>(1 + k / EarlyRecords::kOfSenderMax)};
    ASSERT_TRUE(records.add(record));
  }
  EarlyRecord another = update(1s, 2);
  another.sender = PeerId{1000};
  EXPECT_FALSE(records.add(another));
}

TEST(EarlyRecords, ForgetAllOfAnotherLife) {
  EarlyRecords records;
  EXPECT_TRUE(records.add(update(1s, 1)));
  records.clear();
  EXPECT_FALSE(records.take_until(sim(1s)).has_value());
}

}  // namespace peerd::replication::early_records_test
