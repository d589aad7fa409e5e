#include "core/sparse_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <string>

namespace peerd {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(SparseTable, BeginsWithoutItems) {
  const SparseTable<std::string> table(3);
  EXPECT_EQ(table.size(), 3u);
  EXPECT_THAT(table.numbers(), IsEmpty());
  for (const std::size_t i : {0u, 1u, 2u}) EXPECT_EQ(table.find(i), nullptr);
}

TEST(SparseTable, NamesItemsInTheOrderInWhichTheyCame) {
  SparseTable<std::string> table(3);
  table.add(2, "two");
  table.add(0, "zero");
  table.push_back("three");
  EXPECT_THAT(table.numbers(), ElementsAre(2, 0, 3));
  EXPECT_EQ(table.size(), 4u);
  EXPECT_EQ(table[0], "zero");
  EXPECT_EQ(table[3], "three");
  EXPECT_FALSE(table.contains(1));
}

TEST(SparseTable, AnItemsMemoryIsTheNextOnes) {
  SparseTable<std::string> table(5);
  table.add(3, "three");
  const std::string* const one = &table.add(1, "one");
  const std::string* const four = &table.add(4, "four");
  table.erase(1);
  EXPECT_THAT(table.numbers(), ElementsAre(3, 4));
  EXPECT_EQ(table.find(1), nullptr);
  EXPECT_EQ(&table.add(0, "zero"), one);
  table.erase(0);
  table.erase(3);
  EXPECT_THAT(table.numbers(), ElementsAre(4));
  EXPECT_EQ(table.find(4), four);
  EXPECT_EQ(table[4], "four");
  EXPECT_EQ(table.add(1, "one again"), "one again");
  EXPECT_THAT(table.numbers(), ElementsAre(4, 1));
}

TEST(SparseTable, ItemsStayWhereTheyAre) {
  SparseTable<int> table(1000);
  const int* const first = &table.add(500, 7);
  for (std::size_t i = 0; i < 500; ++i) table.add(i, 0);
  for (int i = 0; i < 1000; ++i) table.push_back(i);
  EXPECT_EQ(table.find(500), first);
  const SparseTable<int> moved = std::move(table);
  EXPECT_EQ(moved.find(500), first);
  EXPECT_EQ(moved[500], 7);
}

}  // namespace
TEST(SparseTable, HashesTheNumbersOfALargeTable) {
  SparseTable<int> table(std::size_t{1} << 32);
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const std::uint32_t number = i * 4294967;
    table.add(number, static_cast<int>(i));
    numbers.push_back(number);
  }
  EXPECT_EQ(table.find(1), nullptr);
  for (std::uint32_t i = 0; i < 1000; i += 2) table.erase(numbers[i]);
  EXPECT_EQ(table.numbers().size(), 500u);
  for (std::uint32_t i = 0; i < 1000; ++i) {
    ASSERT_EQ(table.contains(numbers[i]), i % 2 == 1);
    if (i % 2 == 0) continue;
    EXPECT_EQ(table[numbers[i]], static_cast<int>(i));
    EXPECT_EQ(table.number_in(table.slot_of(numbers[i])), numbers[i]);
  }
}

TEST(SparseTable, ASlotIsTheNextOnesToo) {
  SparseTable<int> table(10);
  table.add(7, 70);
  table.add(3, 30);
  const std::size_t slot = table.slot_of(7);
  table.erase(7);
  table.add(5, 50);
  EXPECT_EQ(table.slot_of(5), slot);
  EXPECT_EQ(table.slots(), 2u);
  EXPECT_EQ(table.number_in(slot), 5u);
  EXPECT_EQ(table.number_in(table.slot_of(3)), 3u);
}

// Numbers that come and go, some of them many that follow each other: as a std::map has them.
TEST(NumberMap, HasWhatWasAddedAndNotErased) {
  std::mt19937 rng(3);
  NumberMap<int> map;
  std::map<std::uint32_t, int> expected;
  for (int step = 0; step < 20000; ++step) {
    const std::uint32_t number = rng() % 2 == 0 ? rng() % 300 : (rng() % 300) * 0x9E3779B9U;
    const auto at = expected.find(number);
    if (at == expected.end()) {
      ASSERT_EQ(map.find(number), nullptr) << "step " << step;
      map.add(number, step);
      expected.emplace(number, step);
    } else {
      ASSERT_NE(map.find(number), nullptr) << "step " << step;
      EXPECT_EQ(*map.find(number), at->second);
      map.erase(number);
      expected.erase(at);
    }
    ASSERT_EQ(map.size(), expected.size());
  }
  ASSERT_GT(expected.size(), 100U);
  for (const auto& [number, item] : expected) EXPECT_EQ(*map.find(number), item);
}

TEST(NumberMap, IsEmptyAtFirstAndAgain) {
  NumberMap<int> map;
  EXPECT_EQ(map.find(0), nullptr);
  map.add(0, 7);
  map.erase(0);
  EXPECT_EQ(map.find(0), nullptr);
  EXPECT_EQ(map.size(), 0U);
}

}  // namespace peerd
