#pragma once
#include <array>
#include <cstdint>

#include "collision/query/wide_motion.hpp"

namespace peerd::collision {

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
