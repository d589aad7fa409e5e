#pragma once
#include <array>
#include <cstdint>

#include "collision/relative_motion.hpp"
#include "collision/wide_tree.hpp"

namespace peerd::collision {

// What the vector unit does of a query. All of it errs on the safe side only: what it leaves out certainly doesn't
// touch.

// Takes B's tree to A's and back, in binary32.
struct WideMotion {
  // What is nearer than `room_m` overlaps, too.
  WideMotion(const WideTree& a, const WideTree& b, const RelativeMotion& motion, double room_m = 0.0);

  using Matrix = std::array<std::array<float, 3>, 3>;
  Matrix a_from_b, b_from_a;              // the rotations, between the trees' scales
  Matrix a_from_b_sizes, b_from_a_sizes;  // their absolute values
  std::array<float, 3> b_in_a, a_in_b;    // the origins
  // More than all of this can be wrong about the place of a point: the rounding of the trees, of the motion, of taking
  // it there and of comparing it there. On A's scale, and on B's.
  float slack_a, slack_b;
  float scale_a_from_b;  // A's scale over B's
};

using Masks = std::array<std::uint8_t, WideTree::kWidth>;  // by B's child or triangle; bit i: A's child or triangle i

// Which children's boxes may overlap: by the three axes of either frame.
void test_nodes(const WideTree::Node& a, const WideTree::Node& b, const WideMotion& motion, Masks& masks);
// A leaf's box against a node's children; bit i: child i.
[[nodiscard]] std::uint8_t test_node_leaf(const WideTree::Node& a, const WideTree::Leaf& b, const WideMotion& motion);
[[nodiscard]] std::uint8_t test_leaf_node(const WideTree::Leaf& a, const WideTree::Node& b, const WideMotion& motion);
// Which triangles may touch: by their boxes in A's frame, and by the plane of either triangle.
void test_leaves(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& motion, Masks& masks);

// How material points move at an instant, relative to the trees' origins: base + turn x place, each in its tree's own
// frame [m/s, rad/s].
struct WideSpeeds {
  std::array<float, 3> base_a, turn_a, base_b, turn_b;
  float rate_a, rate_b;  // of turning, at least |turn| [rad/s]
  float spare_m_s;       // what the velocities of points may change by, on average, until the end, and all rounding
};

// Which children's boxes may meet within that time; which triangles may.
void nodes_may_meet(const WideTree::Node& a, const WideTree::Node& b, const WideMotion& motion,
                    const WideSpeeds& speeds, float within_s, Masks& masks);
void leaves_may_meet(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& motion,
                     const WideSpeeds& speeds, float within_s, Masks& masks);

// By B's child or triangle, then A's.
using DistanceRows = std::array<std::array<float, WideTree::kWidth>, WideTree::kWidth>;
// On A's scale: no two points are nearer. Only of what is there.
struct Distances {
  DistanceRows lower;
  Masks below;    // which are below `most`
  float skipped;  // the least of all others; +inf where there are none
};
// Of the first boxes of two nodes: the gaps along the axes of either frame, and along the line of their centers.
void distances_of_nodes(const WideTree::Node& a, std::uint32_t count_a, const WideTree::Node& b, std::uint32_t count_b,
                        const WideMotion& motion, float most, Distances& distances);
// Of triangles: their gaps along the line of the leaves' centers and along `guess`, any direction from A to B; where
// neither reaches `most`, along that of their nearest points. Those points' distances are `estimates` where `below`
// says so, as rounded: nothing is certain of them.
void distances_of_leaves(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& motion,
                         const std::array<float, 3>& guess, float most, Distances& distances, DistanceRows& estimates);

}  // namespace peerd::collision
