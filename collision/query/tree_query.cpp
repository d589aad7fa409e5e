#include "collision/query/tree_query.hpp"

namespace peerd::collision {
namespace {

// Takes the nodes of B to A's frame by combinations of three slabs.
template <int K>
auto by_slabs(const KdopTree<K>& b, const RelativeMotion& a_from_b) {
  return [&b, realign = Realignment<K>(a_from_b, largest_coordinate(b.soup().box))](std::uint32_t node) {
    return realign(b.node(node).dop);
  };
}

}  // namespace

template <int K>
bool find_pair(KdopTree<K>& a, KdopTree<K>& b, const RelativeMotion& a_from_b, QueryCounters& counters,
               PolygonPair& pair) {
  return find_pair_by(a, b, a_from_b, counters, by_slabs(b, a_from_b), pair);
}

template <int K>
std::vector<PolygonPair> all_pairs(KdopTree<K>& a, KdopTree<K>& b, const RelativeMotion& a_from_b,
                                   QueryCounters& counters) {
  return all_pairs_by(a, b, a_from_b, counters, by_slabs(b, a_from_b));
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
