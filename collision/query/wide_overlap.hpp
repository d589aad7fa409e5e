#pragma once
#include <array>
#include <cstdint>

#include "collision/query/wide_motion.hpp"

namespace peerd::collision {

// Finds which children's boxes may overlap, by the fifteen axes of oriented boxes.
void test_nodes(const WideTree::Node& a, const WideTree::Node& b, const WideMotion& motion, LanePairs& pairs);
// Tests a leaf, which has that oriented box, against a node's children; bit i of the result is child i.
[[nodiscard]] std::uint8_t test_node_leaf(const WideTree::Node& a, const OrientedBox& box_b, const WideTree::Leaf& b,
                                          const WideMotion& motion);
[[nodiscard]] std::uint8_t test_leaf_node(const OrientedBox& box_a, const WideTree::Leaf& a, const WideTree::Node& b,
                                          const WideMotion& motion);
// Finds which triangles may touch, by their boxes in A's frame, and by the plane of either triangle.
void test_leaves(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& motion, Masks& masks);

}  // namespace peerd::collision
