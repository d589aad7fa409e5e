#include "replication/objects/ghosts/ghost_digest.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::ghost_digest_test {

using namespace test;

KinematicState at(double x) { return moving({x, 2, -3}); }

TEST(GhostSums, DependOnPlacesAndObjectsAndNotOnTheirOrder) {
  GhostSums forth, back, elsewhere, other;
  for (std::uint32_t k = 0; k < 100; ++k) forth.add(ObjectId{k}, at(k));
  for (std::uint32_t k = 100; k-- > 0;) back.add(ObjectId{k}, at(k));
  for (std::uint32_t k = 0; k < 100; ++k) elsewhere.add(ObjectId{k}, at(k == 41 ? 41.00001 : k));
  for (std::uint32_t k = 1; k <= 100; ++k) other.add(ObjectId{k}, at(k));
  EXPECT_EQ(forth.groups(), back.groups());
  EXPECT_NE(forth.groups(), other.groups());
  for (std::size_t group = 0; group < kGhostGroups; ++group) {
    const bool is_its = group == ghost_group(ObjectId{41});
    EXPECT_EQ(forth.of_group(group) != elsewhere.of_group(group), is_its) << group;
    for (std::size_t bucket = 0; bucket < kGhostBuckets; ++bucket) {
      const bool is_in = is_its && bucket == ghost_bucket(ObjectId{41});
      EXPECT_EQ(forth.buckets_of(group)[bucket] != elsewhere.buckets_of(group)[bucket], is_in) << group << bucket;
    }
  }
}

TEST(GhostSums, DoNotTellTwoQuaternionsOfOneOrientation) {
  GhostSums plus, minus;
  KinematicState s = at(1);
  s.orientation = Quat(Eigen::AngleAxisd(1.0, Vec3::UnitY()));
  plus.add(ObjectId{1}, s);
  s.orientation.coeffs() = -s.orientation.coeffs();
  minus.add(ObjectId{1}, s);
  EXPECT_EQ(plus.groups(), minus.groups());
}

TEST(GhostSums, AreZeroForNothingAlone) {
  EXPECT_EQ(GhostSums().groups(), (std::array<std::uint16_t, kGhostGroups>{}));
  for (std::uint32_t k = 0; k < 200'000; ++k) {
    GhostSums one;
    one.add(ObjectId{k}, at(0));
    ASSERT_NE(one.of_group(ghost_group(ObjectId{k})), 0) << k;
  }
}

// Groups and buckets are about even, also for the numbers that follow each other.
TEST(GhostSums, ObjectsAreSpread) {
  std::array<std::size_t, kGhostGroups> groups{};
  std::set<std::pair<std::size_t, std::size_t>> buckets;
  for (std::uint32_t k = 0; k < 1000; ++k) {
    ++groups[ghost_group(ObjectId{k})];
    buckets.emplace(ghost_group(ObjectId{k}), ghost_bucket(ObjectId{k}));
  }
  for (const std::size_t count : groups) EXPECT_NEAR(static_cast<double>(count), 250.0, 60.0);
  EXPECT_GT(buckets.size(), kGhostGroups * kGhostBuckets * 95 / 100);
}

}  // namespace peerd::replication::ghost_digest_test
