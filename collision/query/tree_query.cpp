#include "collision/query/tree_query.hpp"

#include <algorithm>
#include <cassert>

#include "collision/exact/triangle_pair.hpp"

namespace peerd::collision {
namespace {

template <int K, class Found>  // Found(PolygonPair) -> bool: true ends the search
class Descent {
 public:
  Descent(KdopTree<K>& a, KdopTree<K>& b, const RelativeMotion& a_from_b, QueryCounters& counters, Found found)
      : a_(a),
        b_(b),
        a_from_b_(a_from_b),
        realign_(a_from_b, largest_coordinate(b.soup().box)),
        counters_(counters),
        found_(found) {}

  // True where found_ has ended the search.
  bool run() {
    return touching(KdopTree<K>::kRoot, realigned(KdopTree<K>::kRoot)) &&
           descend(KdopTree<K>::kRoot, KdopTree<K>::kRoot);
  }

 private:
  WideKdop<K> realigned(std::uint32_t of_b) {
    assert(of_b < b_.nodes().size());
    ++counters_.bv_updates;
    return realign_(b_.node(of_b).dop);
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
  Realignment<K> realign_;
  QueryCounters& counters_;
  Found found_;
};

}  // namespace

template <int K>
bool find_pair(KdopTree<K>& a, KdopTree<K>& b, const RelativeMotion& a_from_b, QueryCounters& counters,
               PolygonPair& pair) {
  const auto first = [&](const PolygonPair& found) {
    pair = found;
    return true;
  };
  return Descent(a, b, a_from_b, counters, first).run();
}

template <int K>
std::vector<PolygonPair> all_pairs(KdopTree<K>& a, KdopTree<K>& b, const RelativeMotion& a_from_b,
                                   QueryCounters& counters) {
  std::vector<PolygonPair> pairs;
  const auto every = [&](const PolygonPair& found) {
    pairs.push_back(found);
    return false;
  };
  (void)Descent(a, b, a_from_b, counters, every).run();
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

template bool find_pair(KdopTree<6>&, KdopTree<6>&, const RelativeMotion&, QueryCounters&, PolygonPair&);
template bool find_pair(KdopTree<14>&, KdopTree<14>&, const RelativeMotion&, QueryCounters&, PolygonPair&);
template bool find_pair(KdopTree<18>&, KdopTree<18>&, const RelativeMotion&, QueryCounters&, PolygonPair&);
template bool find_pair(KdopTree<26>&, KdopTree<26>&, const RelativeMotion&, QueryCounters&, PolygonPair&);
template std::vector<PolygonPair> all_pairs(KdopTree<6>&, KdopTree<6>&, const RelativeMotion&, QueryCounters&);
template std::vector<PolygonPair> all_pairs(KdopTree<14>&, KdopTree<14>&, const RelativeMotion&, QueryCounters&);
template std::vector<PolygonPair> all_pairs(KdopTree<18>&, KdopTree<18>&, const RelativeMotion&, QueryCounters&);
template std::vector<PolygonPair> all_pairs(KdopTree<26>&, KdopTree<26>&, const RelativeMotion&, QueryCounters&);

}  // namespace peerd::collision
