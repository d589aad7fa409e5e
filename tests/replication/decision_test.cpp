#include "replication/decision.hpp"

#include <gtest/gtest.h>

namespace peerd::replication {
namespace {

TEST(DeciderById, IsTheLowerOfTwoOrTheOnlyOne) {
  const PeerId one{1}, two{2};
  EXPECT_EQ(decider_by_id(one, two), one);
  EXPECT_EQ(decider_by_id(two, one), one);
  EXPECT_EQ(decider_by_id(two, two), two);
  EXPECT_EQ(decider_by_id(kNobody, two), two);
  EXPECT_EQ(decider_by_id(two, kNobody), two);
  EXPECT_EQ(decider_by_id(kNobody, kNobody), kNobody);
}

}  // namespace
}  // namespace peerd::replication
