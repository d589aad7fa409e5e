#include "peerd/net/transport/region_groups.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "tests/must.hpp"

namespace peerd::net::region_groups_test {

using testing::HasSubstr;

GroupPlan plan_of(const char* base) { return must(parse_group_plan(base, 4000)); }

struct Case {
  const char *name, *base;
  std::uint32_t region;
  const char* group;  // nullptr: beyond the range
};
class RegionGroups : public testing::TestWithParam<Case> {};
TEST_P(RegionGroups, MapThereAndBack) {
  const Case& c = GetParam();
  const GroupPlan plan = plan_of(c.base);
  const auto endpoint = group_endpoint(plan, RegionId{c.region});
  if (!c.group) {
    ASSERT_FALSE(endpoint) << endpoint->address();
    EXPECT_EQ(endpoint.error().kind, NetError::Kind::kLimit);
    EXPECT_THAT(endpoint.error().sentence, HasSubstr("region " + std::to_string(c.region) + " has no multicast group"));
    return;
  }
  ASSERT_TRUE(endpoint) << endpoint.error().sentence;
  EXPECT_EQ(endpoint->address().to_string(), c.group);
  EXPECT_EQ(endpoint->port(), 4000);
  EXPECT_EQ(group_number(plan, endpoint->address()), c.region);
}
INSTANTIATE_TEST_SUITE_P(
    Table, RegionGroups,
    testing::Values(Case{"First", "239.192.0.0", 0, "239.192.0.0"}, Case{"Carries", "239.192.0.255", 1, "239.192.1.0"},
                    Case{"LastOfRange", "239.255.255.254", 1, "239.255.255.255"},
                    Case{"BeyondRange", "239.255.255.254", 2, nullptr},
                    Case{"FarBeyondRange", "239.192.0.0", 0xFFFF'FFFF, nullptr},
                    Case{"FirstV6", "ff15::1:0:0", 0, "ff15::1:0:0"},
                    Case{"LastRegionV6", "ff15::", 0xFFFF'FFFF, "ff15::ffff:ffff"},
                    Case{"CarriesV6", "ff15::ffff:ffff", 1, "ff15::1:0:0"},
                    Case{"CarriesOverTheMiddleV6", "ff15::ffff:ffff:ffff:ffff", 2, "ff15:0:0:1::1"},
                    Case{"LastOfScopeV6", "ff15:ffff:ffff:ffff:ffff:ffff:ffff:fffe", 1,
                         "ff15:ffff:ffff:ffff:ffff:ffff:ffff:ffff"},
                    Case{"BeyondScopeV6", "ff15:ffff:ffff:ffff:ffff:ffff:ffff:fffe", 2, nullptr}),
    [](const auto& c) { return std::string(c.param.name); });

TEST(RegionGroups, AnyRegionMapsThereAndBack) {
  std::mt19937 random(42);
  for (const char* base : {"239.192.0.0", "ff15::", "ff12:0:0:7:ffff:ffff:ffff:fff0"}) {
    const GroupPlan plan = plan_of(base);
    for (int i = 0; i < 1000; ++i) {
      const auto number = static_cast<std::uint32_t>(random());
      const RegionId region{plan.base.is_v4() ? number >> 10 : number};  // 2^22 groups from 239.192.0.0 on
      const auto endpoint = must(group_endpoint(plan, region));
      ASSERT_EQ(group_number(plan, endpoint.address()), region.value) << endpoint.address();
    }
  }
}

TEST(RegionGroups, AddressesOutsideOfThePlanHaveNoRegion) {
  const auto region = [](const char* base, const char* group) {
    return group_number(plan_of(base), asio::ip::make_address(group));
  };
  EXPECT_FALSE(region("239.192.0.1", "239.192.0.0"));
  EXPECT_FALSE(region("239.192.0.0", "240.0.0.0"));
  EXPECT_FALSE(region("239.192.0.0", "ff15::1"));
  EXPECT_FALSE(region("ff15::2", "ff15::1"));
  EXPECT_FALSE(region("ff15::", "ff15::1:0:0"));
  EXPECT_FALSE(region("ff15::", "ff18::"));
  EXPECT_FALSE(region("ff15::", "2001:db8::1"));
  EXPECT_FALSE(region("ff15::", "239.192.0.0"));
}

// ---- a pool ----

TEST(GroupPool, AnyRegionHasOneOfItsGroups) {
  std::mt19937 random(7);
  for (const char* base : {"239.192.0.0", "ff15::"}) {
    for (const std::uint32_t pool : {1u, 2u, 7u, 64u, 65'536u}) {
      const auto plan = must(parse_group_plan(base, 4000, pool));
      for (int i = 0; i < 1000; ++i) {
        const RegionId region{static_cast<std::uint32_t>(random())};
        const auto endpoint = must(group_endpoint(plan, region));
        ASSERT_LT(group_number(plan, region), pool);
        ASSERT_EQ(group_number(plan, endpoint.address()), group_number(plan, region));
      }
    }
  }
}

// The hash is part of the protocol: all builds must map a region to the same group.
TEST(GroupPool, WhichOneIsFixedForEver) {
  const auto plan = must(parse_group_plan("239.192.80.0", 4000, 64));
  std::vector<std::uint32_t> numbers;
  for (const std::uint32_t region : {0u, 1u, 2u, 3u, 1000u, 0xFFFF'FFFFu})
    numbers.push_back(group_number(plan, RegionId{region}));
  EXPECT_THAT(numbers, testing::ElementsAre(0u, 0x514E28B7u % 64, 0x30F4C306u % 64, 0x85F0B427u % 64, 0x66692658u % 64,
                                            0x81F16F39u % 64));
}

// The rows and columns of a grid spread over the pool, although its side is a multiple of the pool's size.
TEST(GroupPool, NeighboursOfAGridAreSpread) {
  const auto plan = must(parse_group_plan("239.192.0.0", 4000, 16));
  for (std::uint32_t line = 0; line < 64; ++line) {
    std::set<std::uint32_t> row, column;
    for (std::uint32_t i = 0; i < 64; ++i) {
      row.insert(group_number(plan, RegionId{line * 64 + i}));
      column.insert(group_number(plan, RegionId{i * 64 + line}));
    }
    EXPECT_GE(row.size(), 12u) << line;
    EXPECT_GE(column.size(), 12u) << line;
  }
}

TEST(GroupPool, AGroupPastItIsNone) {
  const auto plan = must(parse_group_plan("239.192.0.0", 4000, 4));
  EXPECT_EQ(group_number(plan, asio::ip::make_address("239.192.0.3")), 3u);
  EXPECT_FALSE(group_number(plan, asio::ip::make_address("239.192.0.4")));
}

TEST(GroupPool, MustFitBehindItsBase) {
  EXPECT_TRUE(parse_group_plan("239.255.255.0", 4000, 256));
  EXPECT_THAT(error_of(parse_group_plan("239.255.255.0", 4000, 257)),
              IsError(NetError::Kind::kBadSetting,
                      HasSubstr("a pool of 257 groups from 239.255.255.0 on leaves the multicast range")));
}

TEST(GroupsOfAWorld, AreItsOwnButThatOfTheWholeScene) {
  for (const char* base : {"239.192.80.0", "ff15::1:0:0"}) {
    std::set<asio::ip::address> firsts;
    for (std::uint64_t world = 0; world < 64; ++world) {
      const GroupPlan plan = plan_of_world(plan_of(base), 0x9E37'79B9'7F4A'7C15 * world);
      EXPECT_EQ(group_endpoint(plan, RegionId{0})->address(), plan.base);
      for (const std::uint32_t region : {0u, 1u, 2u, 64u, 1023u, 65'536u}) {
        const auto endpoint = must(group_endpoint(plan, RegionId{region}));
        EXPECT_EQ(region_of_group(plan, must(group_number(plan, endpoint.address()))), RegionId{region});
      }
      firsts.insert(group_endpoint(plan, RegionId{1})->address());
    }
    EXPECT_GT(firsts.size(), 50u) << "of 64";
  }
}

TEST(GroupsOfAWorld, AreThoseOfAllWhereFewFollowTheBase) {
  const GroupPlan plan = plan_of_world(plan_of("239.255.240.0"), 77);
  EXPECT_EQ(group_endpoint(plan, RegionId{5})->address().to_string(), "239.255.240.5");
}

TEST(GroupsOfAWorld, AGroupBetweenTheWholeScenesAndTheFirstIsOfNoRegion) {
  GroupPlan plan = plan_of("239.192.80.0");
  plan.offset = 1024;
  EXPECT_FALSE(region_of_group(plan, 1024));
  EXPECT_EQ(region_of_group(plan, 1025), RegionId{1});
}

struct Garbage {
  const char *name, *base;
  std::uint16_t port;
  const char* sentence;
};
class GroupPlanRefusal : public testing::TestWithParam<Garbage> {};
TEST_P(GroupPlanRefusal, SaysWhatToDo) {
  const Garbage& c = GetParam();
  EXPECT_THAT(error_of(parse_group_plan(c.base, c.port)), IsError(NetError::Kind::kBadSetting, HasSubstr(c.sentence)));
}
INSTANTIATE_TEST_SUITE_P(
    Table, GroupPlanRefusal,
    testing::Values(Garbage{"Text", "multicast please", 4000, "\"multicast please\" is not an IP address"},
                    Garbage{"Empty", "", 4000, "\"\" is not an IP address"},
                    Garbage{"FiveParts", "239.192.0.0.0", 4000, "is not an IP address"},
                    Garbage{"Unicast", "192.0.2.1", 4000, "192.0.2.1 is not a multicast address"},
                    Garbage{"UnicastV6", "2001:db8::1", 4000, "2001:db8::1 is not a multicast address"},
                    Garbage{"NoPort", "239.192.0.0", 0, "port 0"}),
    [](const auto& c) { return std::string(c.param.name); });

}  // namespace peerd::net::region_groups_test
