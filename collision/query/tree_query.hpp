#pragma once
#include <compare>
#include <cstdint>
#include <vector>

#include "collision/exact/orientation.hpp"
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

// The polygons of A and B that share a point, B's vertices being taken to A's frame by `a_from_b`. The recursion is the
// thesis's listing 3.4, with the case that the listing forgets: a leaf against a node with children, either way round.
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

}  // namespace peerd::collision
