#pragma once
#include <algorithm>
#include <cassert>
#include <compare>
#include <cstdint>
#include <vector>

#include "collision/exact/orientation.hpp"
#include "collision/exact/triangle_pair.hpp"
#include "collision/tree/kdop_tree.hpp"
#include "collision/tree/realignment.hpp"

namespace peerd::collision {

// Work done by queries: the terms of the thesis's cost function T = Nv * Cv + Np * Cp + Nu * Cu (section 3.1) without
// its prices.
struct QueryCounters {
  std::uint64_t bv_tests = 0;        // Nv: pairs of bounding volumes compared
  std::uint64_t bv_updates = 0;      // Nu: bounding volumes realigned
  std::uint64_t triangle_tests = 0;  // Np
  std::uint64_t certain_pairs = 0;   // pairs of triangles that touch, for which binary32 was enough
  OrientationCounters orientation;   // the work of the triangle tests
};

struct PolygonPair {
  std::uint32_t a, b;
  friend auto operator<=>(const PolygonPair&, const PolygonPair&) = default;
};

// The polygons of A and B that share a point, B's vertices being taken to A's frame by `a_from_b`, and B's
// nodes by combinations of three slabs (realignment.hpp).
//
// Finds one true pair; which one depends on the trees. The result is false, and `pair` is left as it was, where there
// is none.
template <int K>
[[nodiscard]] bool find_pair(KdopTree<K>& a, KdopTree<K>& b, const RelativeMotion& a_from_b, QueryCounters& counters,
                             PolygonPair& pair);
// All true pairs, sorted, each once.
template <int K>
[[nodiscard]] std::vector<PolygonPair> all_pairs(KdopTree<K>& a, KdopTree<K>& b, const RelativeMotion& a_from_b,
                                                 QueryCounters& counters);

// The recursion of the thesis's listing 3.4 over two k-DOP trees, with the case that the listing forgets: a leaf
// against a node with children, either way round.
//   Realign(node of B) -> WideKdop<K>   contains the node's triangles as a_from_b rounds them, in A's frame
//   Found(PolygonPair) -> bool          is called for each true pair; true ends the search
template <int K, class Realign, class Found>
class TreeDescent {
 public:
  TreeDescent(KdopTree<K>& a, KdopTree<K>& b, const RelativeMotion& a_from_b, QueryCounters& counters, Realign realign,
              Found found)
      : a_(a), b_(b), a_from_b_(a_from_b), counters_(counters), realign_(realign), found_(found) {}

  // True where found_ has ended the search.
  bool run() {
    return touching(KdopTree<K>::kRoot, realigned(KdopTree<K>::kRoot)) &&
           descend(KdopTree<K>::kRoot, KdopTree<K>::kRoot);
  }

 private:
  WideKdop<K> realigned(std::uint32_t of_b) {
    assert(of_b < b_.nodes().size());
    ++counters_.bv_updates;
    return realign_(of_b);
  }
  bool touching(std::uint32_t of_a, const WideKdop<K>& of_b) {
    ++counters_.bv_tests;
    return overlap(a_.node(of_a).dop, of_b);
  }

  // Descends from two nodes that overlap. The recursion is as deep as the higher of the trees.
  bool descend(std::uint32_t of_a, std::uint32_t of_b) {
    const std::uint32_t below_a = a_.children(of_a), below_b = b_.children(of_b);
    if (below_a == KdopTree<K>::kLeaf && below_b == KdopTree<K>::kLeaf) return test_triangles(of_a, of_b);
    const bool split_a = below_a != KdopTree<K>::kLeaf, split_b = below_b != KdopTree<K>::kLeaf;
    for (std::uint32_t j = 0; j < (split_b ? 2u : 1u); ++j) {
      const std::uint32_t next_b = split_b ? below_b + j : of_b;
      const WideKdop<K> dop_b = realigned(next_b);
      for (std::uint32_t i = 0; i < (split_a ? 2u : 1u); ++i) {
        const std::uint32_t next_a = split_a ? below_a + i : of_a;
        if (touching(next_a, dop_b) && descend(next_a, next_b)) return true;
      }
    }
    return false;
  }

  bool test_triangles(std::uint32_t of_a, std::uint32_t of_b) {
    const TriangleSoup &soup_a = a_.soup(), &soup_b = b_.soup();
    for (const std::uint32_t j : b_.triangles(b_.node(of_b))) {
      const Triangle in_b = soup_b.triangle(j);
      const Triangle moved = {a_from_b_(in_b[0]), a_from_b_(in_b[1]), a_from_b_(in_b[2])};
      for (const std::uint32_t i : a_.triangles(a_.node(of_a))) {
        ++counters_.triangle_tests;
        if (touch(soup_a.triangle(i), moved, counters_.orientation) &&
            found_(PolygonPair{soup_a.faces[i].polygon, soup_b.faces[j].polygon})) {
          return true;
        }
      }
    }
    return false;
  }

  KdopTree<K>& a_;
  KdopTree<K>& b_;
  const RelativeMotion& a_from_b_;
  QueryCounters& counters_;
  Realign realign_;
  Found found_;
};

// Finds one true pair by such a descent; false, and `pair` is left as it was, where there is none.
template <int K, class Realign>
[[nodiscard]] bool find_pair_by(KdopTree<K>& a, KdopTree<K>& b, const RelativeMotion& a_from_b, QueryCounters& counters,
                                Realign realign, PolygonPair& pair) {
  const auto first = [&](const PolygonPair& found) {
    pair = found;
    return true;
  };
  return TreeDescent(a, b, a_from_b, counters, realign, first).run();
}

// Finds all true pairs by such a descent, sorted, each once.
template <int K, class Realign>
[[nodiscard]] std::vector<PolygonPair> all_pairs_by(KdopTree<K>& a, KdopTree<K>& b, const RelativeMotion& a_from_b,
                                                    QueryCounters& counters, Realign realign) {
  std::vector<PolygonPair> pairs;
  const auto every = [&](const PolygonPair& found) {
    pairs.push_back(found);
    return false;
  };
  (void)TreeDescent(a, b, a_from_b, counters, realign, every).run();
  std::ranges::sort(pairs);
  const auto rest = std::ranges::unique(pairs);
  pairs.erase(rest.begin(), rest.end());
  return pairs;
}

}  // namespace peerd::collision
