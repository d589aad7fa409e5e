#pragma once
#include "collision/query/wide_motion.hpp"

namespace peerd::collision {

// A WideTouch has what binary32 says of pairs of triangles; those that it does not have certainly don't touch.
struct WideTouch {
  LanePairs pairs;       // these certainly touch, or are for the exact test
  std::uint64_t unsure;  // by pair's number: those that are for the exact test
};

// Tests the triangles of two leaves, for a motion that is in range. False where they are so large that binary32 could
// overflow: nothing was tested then.
[[nodiscard]] bool touch_leaves(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& motion,
                                WideTouch& touch);

}  // namespace peerd::collision
