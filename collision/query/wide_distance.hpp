#pragma once
#include <array>
#include <cstdint>

#include "collision/query/wide_motion.hpp"

namespace peerd::collision {

// Indexed by B's child or triangle, then by A's.
using DistanceRows = std::array<std::array<float, WideTree::kWidth>, WideTree::kWidth>;
// Lower bounds of distances, on A's scale: no two points are nearer. Children and triangles that don't exist have none.
struct Distances {
  DistanceRows lower;
  Masks below;    // which are below `most`
  float skipped;  // the least of all others; +inf where there are none
};
// Bounds the distances of the first boxes of two nodes by the gaps along the axes of either frame, and along the line
// of their centres.
void distances_of_nodes(const WideTree::Node& a, std::uint32_t count_a, const WideTree::Node& b, std::uint32_t count_b,
                        const WideMotion& motion, float most, Distances& distances);
// Bounds the distances of triangles by their gaps along the line of the leaves' centres and along `guess`, any
// direction from A to B; where neither reaches `most`, along the line of their nearest points. Those points' distances
// are `estimates` where `below` says so, as rounded: nothing is certain of them.
void distances_of_leaves(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& motion,
                         const std::array<float, 3>& guess, float most, Distances& distances, DistanceRows& estimates);

}  // namespace peerd::collision
