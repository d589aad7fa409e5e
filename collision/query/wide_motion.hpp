#pragma once
#include <array>
#include <cstdint>

#include "collision/exact/relative_motion.hpp"
#include "collision/tree/wide_tree.hpp"

namespace peerd::collision {

// The kernels of a query that run on the vector unit err on the safe side only: what they leave out certainly doesn't
// touch.

// The motion that takes B's tree to A's and back, in binary32.
struct WideMotion {
  // Things nearer than `margin_m` count as overlapping, too.
  WideMotion(const WideTree& a, const WideTree& b, const RelativeMotion& motion, double margin_m = 0.0);

  using Matrix = std::array<std::array<float, 3>, 3>;
  Matrix a_from_b, b_from_a;              // the rotations, between the trees' scales
  Matrix a_from_b_sizes, b_from_a_sizes;  // their absolute values
  std::array<float, 3> b_in_a, a_in_b;    // the origins
  // A bound of the error of a point's place: the rounding of the trees, of the motion, of moving the point and of
  // comparing it there; on A's scale, and on B's.
  float slack_a, slack_b;
  float scale_a_from_b;  // A's scale over B's

  // Whether both trees have one scale, and all coordinates are so small that binary32 can't overflow, whatever is done
  // to boxes. Where not, what is below is not to be used.
  bool in_range;
  // The bound for oriented boxes, along any axis that is no longer than 1.
  float slack_oriented;
  // The motion on that scale in binary64, for places relative to a leaf, and a bound of the error of those.
  std::array<std::array<double, 3>, 3> a_from_b_64;
  std::array<double, 3> b_in_a_64;
  float rounding_64;
};

using Masks = std::array<std::uint8_t, WideTree::kWidth>;  // by B's child or triangle; bit i: A's child or triangle i
static_assert(WideTree::kWidth == 8 * sizeof(Masks::value_type));  // a bit for each child

// Pairs of children or triangles, in B's order, then A's: 8 times B's and A's. There is room for what a vector writes
// beyond the last.
struct LanePairs {
  std::array<std::uint8_t, WideTree::kWidth*(WideTree::kWidth + 1)> at;
  std::size_t count = 0;
  [[nodiscard]] static std::size_t of_a(std::uint8_t pair) { return pair & 7u; }
  [[nodiscard]] static std::size_t of_b(std::uint8_t pair) { return pair >> 3 & 7u; }
};

}  // namespace peerd::collision
