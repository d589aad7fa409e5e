#include "peerd/net/relay/forwarding_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

namespace peerd::relay::forwarding_table_test {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

std::vector<LinkId> visited(const ForwardingTable& table, std::uint32_t region) {
  std::vector<LinkId> links;
  table.visit(RegionId{region}, [&](LinkId link) { links.push_back(link); });
  return links;
}

Wanted these(std::initializer_list<std::uint32_t> regions) {
  Wanted wanted;
  for (const std::uint32_t region : regions) wanted.regions.push_back(RegionId{region});
  return wanted;
}

TEST(ForwardingTable, ARegionGoesWhereItIsWantedOrWhereAllAre) {
  ForwardingTable table;
  EXPECT_TRUE(table.set(1, these({0, 4})));
  EXPECT_TRUE(table.set(2, these({0, 7})));
  EXPECT_TRUE(table.set(3, {.all = true}));
  EXPECT_THAT(visited(table, 4), UnorderedElementsAre(1u, 3u));
  EXPECT_THAT(visited(table, 7), UnorderedElementsAre(2u, 3u));
  EXPECT_THAT(visited(table, 0), UnorderedElementsAre(1u, 2u, 3u));
  EXPECT_THAT(visited(table, 9), ElementsAre(3u));
  EXPECT_FALSE(table.set(2, these({0, 7})));
  EXPECT_TRUE(table.remove(3));
  EXPECT_FALSE(table.remove(3));
  EXPECT_THAT(visited(table, 9), IsEmpty());
}

TEST(ForwardingTable, ALinkIsToldWhatAllOthersWantAndNotWhatItWantsItself) {
  ForwardingTable table;
  (void)table.set(1, these({0, 4}));
  (void)table.set(2, these({0, 7}));
  EXPECT_EQ(table.wanted_by_others(1), these({0, 7}));
  EXPECT_EQ(table.wanted_by_others(2), these({0, 4}));
  EXPECT_EQ(table.wanted_by_others(9), these({0, 4, 7}));
  (void)table.set(3, {.all = true});
  EXPECT_EQ(table.wanted_by_others(1), (Wanted{.all = true}));
  EXPECT_EQ(table.wanted_by_others(3), these({0, 4, 7}));
}

// The truth is a plain map of what each link wants.
TEST(ForwardingTable, EqualsAPlainMapAfterAnyChanges) {
  std::mt19937 random(7);
  ForwardingTable table;
  std::map<LinkId, Wanted> truth;
  for (int step = 0; step < 2'000; ++step) {
    const LinkId link = random() % 6;
    Wanted wanted{.all = random() % 8 == 0};
    for (std::uint32_t region = 0; region < 10 && !wanted.all; ++region) {
      if (random() % 3 == 0) wanted.regions.push_back(RegionId{region});
    }
    EXPECT_EQ(table.set(link, wanted), truth[link] != wanted);
    truth[link] = wanted;
    for (std::uint32_t region = 0; region < 10; ++region) {
      std::vector<LinkId> expected;
      for (const auto& [each, wants] : truth) {
        if (wants.all || std::ranges::binary_search(wants.regions, RegionId{region})) expected.push_back(each);
      }
      ASSERT_THAT(visited(table, region), testing::UnorderedElementsAreArray(expected));
    }
    std::set<RegionId> others;
    bool all = false;
    for (const auto& [each, wants] : truth) {
      if (each == link) continue;
      all |= wants.all;
      others.insert(wants.regions.begin(), wants.regions.end());
    }
    ASSERT_EQ(table.wanted_by_others(link),
              all ? Wanted{.all = true} : (Wanted{.regions = {others.begin(), others.end()}}));
  }
}

}  // namespace peerd::relay::forwarding_table_test
