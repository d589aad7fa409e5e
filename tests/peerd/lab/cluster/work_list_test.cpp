#include "peerd/lab/cluster/work_list.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace peerd::cluster::work_list_test {

struct Case {
  const char* name;
  ItemList items;
  const char* text;
};
class Lists : public testing::TestWithParam<Case> {};
TEST_P(Lists, AreWordsAndBack) {
  const auto& [name, items, text] = GetParam();
  EXPECT_EQ(to_text(items), text);
  EXPECT_EQ(item_list_from(text, 100), items);
}
INSTANTIATE_TEST_SUITE_P(Table, Lists,
                         testing::Values(Case{"One", {7}, "7"}, Case{"Two", {0, 1}, "0-1"},
                                         Case{"Gaps", {0, 2, 3, 4, 99}, "0,2-4,99"}),
                         [](const auto& tested) { return std::string(tested.param.name); });

class NoList : public testing::TestWithParam<const char*> {};
TEST_P(NoList, IsRefused) { EXPECT_FALSE(item_list_from(GetParam(), 100)); }
INSTANTIATE_TEST_SUITE_P(Table, NoList,
                         testing::Values("", ",", "1,", "1-", "-1", "x", "1 2", "2-1", "1,1", "3,2", "100", "5-100",
                                         "0-18446744073709551615", "99999999999999999999", "1-2-3"));

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
