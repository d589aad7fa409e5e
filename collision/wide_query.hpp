#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "collision/relative_motion.hpp"
#include "collision/tree_query.hpp"
#include "collision/wide_tree.hpp"

namespace peerd::collision {

struct FacePair {
  std::uint32_t a, b;  // of the soups
  friend auto operator<=>(const FacePair&, const FacePair&) = default;
};

// The queries of tree_query.hpp on wide trees: the same answers. Eight boxes against eight, then eight triangles
// against eight, in binary32 with room for all of its rounding; what is left goes to the exact test. Which vector
// instructions run is found at run time; no answer, and no counter, depends on it.
//
// An object keeps its memory, so that a query like one before allocates nothing. Not thread-safe.
class WideQuery {
 public:
  // One true pair: of those that there are, the first in the order of the trees. False where there is none.
  [[nodiscard]] bool find_pair(WideTree& a, WideTree& b, const RelativeMotion& a_from_b, PolygonPair& pair);
  // All, sorted, each once; valid until the next query.
  [[nodiscard]] const std::vector<PolygonPair>& all_pairs(WideTree& a, WideTree& b, const RelativeMotion& a_from_b);

  // Triangles no farther apart than that, by triangle_distance(), sorted; valid until the next query.
  [[nodiscard]] const std::vector<FacePair>& faces_within(WideTree& a, WideTree& b, const RelativeMotion& a_from_b,
                                                          double distance_m);

  [[nodiscard]] const QueryCounters& counters() const { return counters_; }

 private:
  template <class Test>
  bool descend(WideTree& a, WideTree& b, const RelativeMotion& a_from_b, double room_m, Test test);

  std::vector<std::pair<WideTree::Place, WideTree::Place>> stack_;  // pairs to visit
  std::vector<PolygonPair> pairs_;
  std::vector<FacePair> faces_;
  QueryCounters counters_;
};

}  // namespace peerd::collision
