#pragma once
#include <cstdint>

#include "collision/query/tree_query.hpp"
#include "collision/tree/kdop_tree.hpp"
#include "collision/tree/realignment.hpp"

namespace peerd::bench {

// The recursion of collision/query/tree_query.cpp, with the bounds of the nodes and what happens where two leaves meet
// left to the experiment:
//   BoundA(node), BoundB(node)    k-DOPs of one frame that contain the nodes
//   AtLeaves(of_a, of_b) -> bool  true ends it
template <int K, class BoundA, class BoundB, class AtLeaves>
struct Descent {
  collision::KdopTree<K>& a;
  collision::KdopTree<K>& b;
  BoundA bound_a;
  BoundB bound_b;
  AtLeaves at_leaves;
  std::uint64_t bv_tests = 0;

  bool run() {
    ++bv_tests;
    return overlap(bound_a(0), bound_b(0)) && descend(0, 0);
  }

 private:
  static constexpr std::uint32_t kLeaf = collision::KdopTree<K>::kLeaf;
  bool descend(std::uint32_t of_a, std::uint32_t of_b) {
    const std::uint32_t below_a = a.children(of_a), below_b = b.children(of_b);
    if (below_a == kLeaf && below_b == kLeaf) return at_leaves(of_a, of_b);
    const bool split_a = below_a != kLeaf, split_b = below_b != kLeaf;
    for (std::uint32_t j = 0; j < (split_b ? 2u : 1u); ++j) {
      const std::uint32_t next_b = split_b ? below_b + j : of_b;
      const auto& dop_b = bound_b(next_b);
      for (std::uint32_t i = 0; i < (split_a ? 2u : 1u); ++i) {
        const std::uint32_t next_a = split_a ? below_a + i : of_a;
        ++bv_tests;
        if (overlap(bound_a(next_a), dop_b) && descend(next_a, next_b)) return true;
      }
    }
    return false;
  }
};
template <int K, class BoundA, class BoundB, class AtLeaves>
Descent(collision::KdopTree<K>&, collision::KdopTree<K>&, BoundA, BoundB, AtLeaves)
    -> Descent<K, BoundA, BoundB, AtLeaves>;

// The benchmarks' objects have vertices that are within a metre or so of their origin.
inline constexpr double kExtent_m = 1.0;

// The returned function gives each pair of triangles of two leaves to test(a, b) -> bool, the second leaf's triangle in
// the first one's frame.
template <int K, class Test>
auto each_pair(const collision::KdopTree<K>& a, const collision::KdopTree<K>& b,
               const collision::RelativeMotion& a_from_b, Test test) {
  return [&a, &b, &a_from_b, test](std::uint32_t of_a, std::uint32_t of_b) mutable {
    for (const std::uint32_t j : b.triangles(b.node(of_b))) {
      const collision::Triangle t = b.soup().triangle(j);
      const collision::Triangle moved = {a_from_b(t[0]), a_from_b(t[1]), a_from_b(t[2])};
      for (const std::uint32_t i : a.triangles(a.node(of_a))) {
        if (test(a.soup().triangle(i), moved)) return true;
      }
    }
    return false;
  };
}

// The library does the same: B's nodes are realigned to A's frame when they are visited.
template <int K, class Test>
bool descend_pairs(collision::KdopTree<K>& a, collision::KdopTree<K>& b, const collision::RelativeMotion& a_from_b,
                   Test test) {
  const collision::Realignment<K> realign(a_from_b, kExtent_m);
  return Descent(
             a, b, [&](std::uint32_t i) -> const collision::Kdop<K>& { return a.node(i).dop; },
             [&](std::uint32_t i) { return realign(b.node(i).dop); }, each_pair(a, b, a_from_b, test))
      .run();
}

}  // namespace peerd::bench
