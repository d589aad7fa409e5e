#pragma once
#include <array>
#include <cstdint>

#include "collision/relative_motion.hpp"
#include "collision/wide_tree.hpp"

namespace peerd::collision {

// What the vector unit does of a query. All of it errs on the safe side only: what it leaves out certainly doesn't
// touch.

// Takes B's tree to A's, relative to their origins, in binary32.
struct WideMotion {
  WideMotion(const WideTree& a, const WideTree& b, const RelativeMotion& a_from_b);

  std::array<std::array<float, 3>, 3> rotation, magnitude;  // A from B, and its absolute values
  std::array<float, 3> there;                               // B's origin, in A's frame [m]
  std::array<float, 3> back;                                // A's origin, in B's frame [m]
  // More than all of this can be wrong about the place of a point [m]: the rounding of the trees, of the motion, of
  // taking it there and of comparing it there.
  float slack_m;
};

using Masks = std::array<std::uint8_t, WideTree::kWidth>;  // by B's child or triangle; bit i: A's child or triangle i

// Which children's boxes may overlap: by the three axes of either frame.
void test_nodes(const WideTree::Node& a, const WideTree::Node& b, const WideMotion& motion, Masks& masks);
// A leaf's box against a node's children; bit i: child i.
[[nodiscard]] std::uint8_t test_node_leaf(const WideTree::Node& a, const WideTree::Leaf& b, const WideMotion& motion);
[[nodiscard]] std::uint8_t test_leaf_node(const WideTree::Leaf& a, const WideTree::Node& b, const WideMotion& motion);
// Which triangles may touch: by their boxes in A's frame, and by the plane of either triangle.
void test_leaves(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& motion, Masks& masks);

// How fast gaps close at most, as reciprocals [s/m], a little less than they are: along the axes of A's frame with B on
// the positive or on the negative side, and along those of B's frame with A there.
struct ClosingTimes {
  std::array<float, 3> in_a_positive, in_a_negative, in_b_positive, in_b_negative;
};

// How long the boxes of children, or of triangles, can certainly not meet [s]: 0 where they overlap. By B's child, then
// A's; for a leaf against a node by the node's child, in the first row.
using Delays = std::array<std::array<float, WideTree::kWidth>, WideTree::kWidth>;
void delays_of_nodes(const WideTree::Node& a, const WideTree::Node& b, const WideMotion& motion,
                     const ClosingTimes& times, Delays& delays);

// A leaf as a node: its triangles' boxes are its children. What isn't there has no box.
[[nodiscard]] WideTree::Node boxes_of(const WideTree::Leaf& leaf);

}  // namespace peerd::collision
