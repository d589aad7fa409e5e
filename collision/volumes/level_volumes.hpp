#pragma once
#include <cstdint>
#include <vector>

#include "collision/tree/kdop_tree.hpp"
#include "collision/tree/kdop_volume.hpp"

namespace peerd::collision {

// The volume [m^3] of all nodes of each level of a tree that is built, with the leaves above that level, from the root
// on (the thesis's figure 3.8).
template <int K>
[[nodiscard]] std::vector<double> level_volumes(const KdopTree<K>& tree) {
  std::vector<double> out;
  std::vector<std::uint32_t> level = {KdopTree<K>::kRoot}, next;
  double of_leaves = 0.0;
  while (!level.empty()) {
    out.push_back(of_leaves);
    next.clear();
    for (const std::uint32_t i : level) {
      const double of_node = volume(widened(tree.node(i).dop));
      out.back() += of_node;
      const std::uint32_t left = tree.node(i).left;
      if (left < KdopTree<K>::kUnsplit) {
        next.insert(next.end(), {left, left + 1});
      } else {
        of_leaves += of_node;
      }
    }
    level.swap(next);
  }
  return out;
}

}  // namespace peerd::collision
