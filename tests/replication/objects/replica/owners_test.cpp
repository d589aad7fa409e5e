#include "replication/objects/replica/owners.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <vector>

namespace peerd::replication::owners_test {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

constexpr ObjectId kOne{1}, kSeven{7}, kNine{9};
constexpr PeerId kA{1}, kB{2};

TEST(Owners, NothingIsOwnedAtFirst) {
  const Owners owners;
  EXPECT_EQ(owners.of(kSeven), kNobody);
  EXPECT_EQ(owners.of(ObjectId(10, 3)), kNobody);
  EXPECT_EQ(owners.size(), 0u);
  EXPECT_THAT(std::vector(owners.begin(), owners.end()), IsEmpty());
}

TEST(Owners, ListsOwnedObjectsInAscendingOrder) {
  Owners owners;
  owners.set(kNine, kA);
  owners.set(kOne, kB);
  owners.set(kSeven, kA);
  EXPECT_THAT(std::vector(owners.begin(), owners.end()),
              ElementsAre(Pair(kOne, kB), Pair(kSeven, kA), Pair(kNine, kA)));
  for (const std::uint32_t first : {2U, 7U}) {
    const auto from = owners.from(ObjectId{first});
    EXPECT_THAT(std::vector(from.begin(), from.end()), ElementsAre(Pair(kSeven, kA), Pair(kNine, kA)));
  }
  for (const std::uint32_t first : {10U, 0xFFFF'FFFFU}) {
    const auto from = owners.from(ObjectId{first});
    EXPECT_EQ(from.begin(), from.end());
  }
}

TEST(Owners, ATableAsAMapIs) {
  std::mt19937_64 rng(1);
  Owners owners;
  std::map<ObjectId, PeerId> expected;
  for (int i = 0; i < 5000; ++i) {
    const ObjectId object(static_cast<std::uint32_t>(rng() % 100), static_cast<std::uint32_t>(rng() % 3));
    const PeerId owner{static_cast<std::uint32_t>(rng() % 4)};
    owners.set(object, owner);
    expected.erase(object);
    if (owner != kNobody) expected.emplace(object, owner);
    ASSERT_EQ(owners.size(), expected.size());
    ASSERT_EQ((std::map<ObjectId, PeerId>(owners.begin(), owners.end())), expected);
  }
}

}  // namespace peerd::replication::owners_test
