#include "tests/collision/scene_hash.hpp"

#include <gtest/gtest.h>

namespace peerd::collision::scene_hash_test {

// tests/collision/hash_everywhere.sh asks other compilers, levels and instruction sets.
TEST(SceneHash, IsTheSameEverywhere) { EXPECT_EQ(scene_hash(), kSceneHash); }
TEST(SceneHash, OfViewsIsTheSameEverywhere) { EXPECT_EQ(view_hash(), kViewHash); }

}  // namespace peerd::collision::scene_hash_test
