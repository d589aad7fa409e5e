#include "tests/collision/scene_hash.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

namespace peerd::collision::scene_hash_test {

// The choice of instructions changes neither an answer nor a counter. tests/collision/hash_everywhere.sh asks other
// compilers and levels besides.
TEST(SceneHash, IsTheSameForEachInstructionSet) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    EXPECT_EQ(scene_hash(), kSceneHash) << target;
    EXPECT_EQ(view_hash(), kViewHash) << target;
  }
  hwy::SetSupportedTargetsForTest(0);
}

}  // namespace peerd::collision::scene_hash_test
