#include "replication/physics/pairs/model_pairs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace peerd::replication::model_pairs_test {

using testing::ElementsAre;
using testing::IsEmpty;

ObjectId id_of(std::uint32_t node) { return ObjectId::unpacked(node + 1); }

std::vector<PairGroup::End> ends_of(const std::vector<std::uint32_t>& nodes) {
  std::vector<PairGroup::End> ends;
  for (const std::uint32_t node : nodes) ends.push_back({id_of(node), node, node % 2 == 0});
  return ends;
}

std::vector<ObjectId> ids_of(const std::vector<std::uint32_t>& nodes) {
  std::vector<ObjectId> ids;
  for (const std::uint32_t node : nodes) ids.push_back(id_of(node));
  return ids;
}

// Each collider with each collidee, each two once, as a list of them is made.
std::vector<CollisionPair> listed(const std::vector<std::uint32_t>& colliders,
                                  const std::vector<std::uint32_t>& collidees) {
  std::vector<CollisionPair> pairs;
  std::set<std::pair<std::uint32_t, std::uint32_t>> known;
  for (const std::uint32_t a : colliders) {
    for (const std::uint32_t b : collidees) {
      if (a == b || !known.insert(std::minmax(a, b)).second) continue;
      const bool mutual =
          std::ranges::find(colliders, b) != colliders.end() && std::ranges::find(collidees, a) != collidees.end();
      pairs.push_back({id_of(a), id_of(b), CollisionType::kBox, mutual});
    }
  }
  return pairs;
}

TEST(PairGroup, HasThePairsOfItsListInTheirOrder) {
  using Nodes = std::vector<std::uint32_t>;
  for (const auto& [colliders, collidees] : {std::pair{Nodes{3, 4, 6, 9}, Nodes{3, 4, 6, 9}},
                                             {Nodes{3, 4, 6, 9}, Nodes{1, 3, 4, 2, 5, 6, 8, 9, 7}},
                                             {Nodes{9, 3}, Nodes{9, 1, 3}},
                                             {Nodes{1, 2, 3}, Nodes{9, 8, 7, 6}},
                                             {Nodes{5}, Nodes{5, 6}}}) {
    ASSERT_TRUE(PairGroup::fits(ids_of(colliders), ids_of(collidees)));
    const PairGroup group(CollisionType::kBox, ends_of(colliders), ends_of(collidees), 100, 1000);
    const std::vector<CollisionPair> expected = listed(colliders, collidees);
    ASSERT_EQ(group.size(), expected.size());
    for (std::uint32_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(key_of(group.pair(i)), key_of(expected[i]));
      EXPECT_EQ(group.pair(i).mutual, expected[i].mutual);
      const PartPair parts = group.part_pair(i);
      EXPECT_EQ(parts.pair, 100 + i);
      EXPECT_EQ(std::pair(id_of(parts.a), id_of(parts.b)), std::pair(expected[i].collider, expected[i].collidee));
      EXPECT_EQ(parts.fixed, parts.a % 2 == 1 && parts.b % 2 == 1) << "neither is a carrier";
    }
    for (const PairGroup::Member& member : group.members()) {
      std::vector<std::uint32_t> numbers, expected_numbers;
      for (std::uint32_t k = 0; k < group.count_of(member); ++k) {
        const std::uint32_t offset = group.offset_of(member, k);
        numbers.push_back(offset);
        const PartPair parts = group.part_pair(offset);
        const std::uint32_t partner = parts.a == member.node ? parts.b : parts.a;
        EXPECT_EQ(group.number_of(member, *group.member(partner)), 100 + offset);
      }
      for (std::uint32_t i = 0; i < expected.size(); ++i) {
        const ObjectId id = id_of(member.node);
        if (expected[i].collider == id || expected[i].collidee == id) expected_numbers.push_back(i);
      }
      EXPECT_EQ(numbers, expected_numbers);
      EXPECT_EQ(group.number_of(member, member), std::nullopt);
    }
    EXPECT_EQ(group.member(77), nullptr);
  }
}

TEST(PairGroup, TwoOfOneSideAloneAreNoPair) {
  const PairGroup group(CollisionType::kBox, ends_of({1, 2}), ends_of({3, 4}), 0, 0);
  EXPECT_EQ(group.number_of(*group.member(1), *group.member(2)), std::nullopt);
  EXPECT_EQ(group.number_of(*group.member(4), *group.member(3)), std::nullopt);
  EXPECT_EQ(group.number_of(*group.member(4), *group.member(2)), 3u);
}

TEST(PairGroup, FitsWhereAllCollidersAreCollideesInOrderOrNoneIs) {
  const auto fits = [](const std::vector<std::uint32_t>& colliders, const std::vector<std::uint32_t>& collidees) {
    return PairGroup::fits(ids_of(colliders), ids_of(collidees));
  };
  EXPECT_TRUE(fits({1, 3}, {1, 2, 3}));
  EXPECT_TRUE(fits({1, 3}, {2, 4}));
  EXPECT_FALSE(fits({3, 1}, {1, 2, 3})) << "another order";
  EXPECT_FALSE(fits({1, 4}, {1, 2, 3})) << "some are";
  EXPECT_FALSE(fits({1, 1}, {2, 3}));
  EXPECT_FALSE(fits({1}, {2, 2}));
}

TEST(PairNumbers, AreListedOrThoseOfGroupsOrAll) {
  EXPECT_THAT(PairNumbers().all(), IsEmpty());
  EXPECT_THAT(PairNumbers::all_below(3).all(), ElementsAre(0, 1, 2));
  const std::vector<std::uint32_t> few{4, 7};
  EXPECT_THAT(PairNumbers(few).all(), ElementsAre(4, 7));
  // Before, between and behind two groups.
  const PairGroup one(CollisionType::kBox, ends_of({1, 2}), ends_of({3, 4}), 2, 20);
  const PairGroup another(CollisionType::kWitness, ends_of({1, 5}), ends_of({1, 5}), 8, 80);
  NodePairs pairs(6);
  for (const std::uint32_t number : {0u, 7u, 7u, 9u}) pairs.add(1, number);
  pairs.add(0, 1);
  const std::vector<const PairGroup*> groups{&one, &another};
  pairs.add_groups(groups, false);
  EXPECT_THAT(pairs.of(1).all(), ElementsAre(0, 2, 3, 7, 8, 9));
  EXPECT_EQ(pairs.of(1).size(), 6u);
  EXPECT_THAT(pairs.of(0).all(), ElementsAre(1));
  EXPECT_THAT(pairs.of(4).all(), ElementsAre(3, 5));
  EXPECT_THAT(pairs.of(99).all(), IsEmpty());
}

TEST(PairList, FindsItemsBeforeBetweenAndBehindGroups) {
  const PairGroup one(CollisionType::kBox, ends_of({1, 2}), ends_of({3, 4}), 1, 1);
  const PairGroup another(CollisionType::kBox, ends_of({1, 5}), ends_of({1, 5}), 6, 6);
  PairList<CollisionPair> list;
  list.push_back({id_of(7), id_of(8)});
  list.add(one);
  list.push_back({id_of(8), id_of(9)});
  list.add(another);
  list.push_back({id_of(9), id_of(7)});
  ASSERT_EQ(list.size(), 8u);
  std::vector<std::uint64_t> colliders;
  for (const CollisionPair pair : list) colliders.push_back(pair.collider.packed() - 1);
  EXPECT_THAT(colliders, ElementsAre(7, 1, 1, 2, 2, 8, 1, 9));
  list.listed(5).mutual = true;
  EXPECT_TRUE(list[5].mutual);
  std::vector<std::uint32_t> numbers;
  list.for_each_listed([&](std::uint32_t number, const CollisionPair& pair) {
    numbers.push_back(number);
    EXPECT_EQ(key_of(pair), key_of(list[number]));
  });
  EXPECT_THAT(numbers, ElementsAre(0, 5, 7));
}

}  // namespace peerd::replication::model_pairs_test
