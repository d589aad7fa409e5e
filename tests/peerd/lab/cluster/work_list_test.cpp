#include "peerd/lab/cluster/work_list.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "tests/must.hpp"

namespace peerd::cluster::work_list_test {

TEST(Ranges, AreWordsAndBack) {
  EXPECT_EQ(range_text({7}), "7-7");
  EXPECT_EQ(range_text({0, 2, 3, 99}), "0-99");
  const auto range = must(item_range_from("3-99", 100));
  EXPECT_EQ(range.first, 3U);
  EXPECT_EQ(range.last, 99U);
}

class NoRange : public testing::TestWithParam<const char*> {};
TEST_P(NoRange, IsRefused) { EXPECT_FALSE(item_range_from(GetParam(), 100)); }
INSTANTIATE_TEST_SUITE_P(Table, NoRange,
                         testing::Values("", "-", "7", "1-", "-1", "x", "1 2", "2-1", "1,1", "5-100", "1-2-3",
                                         "0-18446744073709551615", "99999999999999999999-1"));
TEST(Ranges, AreRefusedWhereThereAreNoItems) { EXPECT_FALSE(item_range_from("0-0", 0)); }

TEST(Deal, GivesEachItemToOneTaskEvenlyAndInOrder) {
  std::mt19937 random(3);
  for (int i = 0; i < 200; ++i) {
    ItemList items(random() % 300);
    std::iota(items.begin(), items.end(), std::size_t{random() % 9});
    const std::size_t tasks = 1 + random() % 100;
    const auto dealt = deal(items, tasks);
    EXPECT_EQ(dealt.size(), std::min(tasks, items.size()));
    ItemList all;
    std::size_t least = items.size(), most = 0;
    for (const ItemList& part : dealt) {
      all.insert(all.end(), part.begin(), part.end());
      least = std::min(least, part.size());
      most = std::max(most, part.size());
    }
    EXPECT_EQ(all, items);
    EXPECT_TRUE(items.empty() || most <= least + 1);
  }
}

}  // namespace peerd::cluster::work_list_test
