#include "collision/scene/collision_changes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace peerd::collision::collision_changes_test {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Objects 0 and 1 are Transforms, 2 is not. Interests: 0 of 0 in 1, 1 of 0 in 2, 2 of 1 in 2.
CollisionChanges three() {
  CollisionChanges changes;
  changes.add_object(ObjectId{10}, true);
  changes.add_object(ObjectId{20}, true);
  changes.add_object(ObjectId{30}, false);
  changes.add_interest(0, 1);
  changes.add_interest(0, 2);
  changes.add_interest(1, 2);
  return changes;
}

TEST(CollisionChanges, SaysWhatBeganAndEnded) {
  CollisionChanges changes = three();
  changes.begin_tick();
  EXPECT_TRUE(changes.set_colliding(2, true));
  EXPECT_TRUE(changes.set_colliding(0, true));
  EXPECT_FALSE(changes.set_colliding(0, true));
  const auto& first = changes.end_tick();
  EXPECT_THAT(first.colliding, ElementsAre(0u, 2u));
  EXPECT_THAT(first.began, ElementsAre(0u, 2u));
  EXPECT_THAT(first.ended, IsEmpty());
  changes.begin_tick();
  changes.set_colliding(0, false);
  changes.set_colliding(1, true);
  const auto& second = changes.end_tick();
  EXPECT_THAT(second.colliding, ElementsAre(1u, 2u));
  EXPECT_THAT(second.began, ElementsAre(1u));
  EXPECT_THAT(second.ended, ElementsAre(0u));
}

// A Transform reports when its first interest begins and its last ends, and only then; other nodes report nothing.
TEST(CollisionChanges, TransformsReportNotColliding) {
  CollisionChanges changes = three();
  changes.begin_tick();
  changes.set_colliding(0, true);
  EXPECT_THAT(changes.end_tick().not_colliding,
              ElementsAre(NotColliding{ObjectId{10}, false}, NotColliding{ObjectId{20}, false}));
  changes.begin_tick();
  changes.set_colliding(1, true);
  EXPECT_THAT(changes.end_tick().not_colliding, IsEmpty());
  changes.begin_tick();
  changes.set_colliding(0, false);
  EXPECT_THAT(changes.end_tick().not_colliding, ElementsAre(NotColliding{ObjectId{20}, true}));
  changes.begin_tick();
  changes.set_colliding(1, false);
  changes.set_colliding(1, true);  // there and back within a tick
  EXPECT_THAT(changes.end_tick().not_colliding, IsEmpty());
}

TEST(CollisionChanges, RefusalsStandUntilTheyAreTakenBack) {
  CollisionChanges changes = three();
  changes.begin_tick();
  changes.refuse(1, "its vertices are too far out");
  ASSERT_EQ(changes.end_tick().refused.size(), 1u);
  changes.begin_tick();
  const auto& kept = changes.end_tick();
  ASSERT_EQ(kept.refused.size(), 1u);
  EXPECT_EQ(kept.refused[0].interest, 1u);
  EXPECT_EQ(kept.refused[0].why, "its vertices are too far out");
  EXPECT_TRUE(changes.is_refused(1));
  changes.begin_tick();
  changes.accept(1);
  changes.accept(2);
  EXPECT_THAT(changes.end_tick().refused, IsEmpty());
}

}  // namespace peerd::collision::collision_changes_test
