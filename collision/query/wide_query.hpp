#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "collision/exact/relative_motion.hpp"
#include "collision/query/tree_query.hpp"
#include "collision/tree/wide_tree.hpp"

namespace peerd::collision {

struct WideMotion;

struct FacePair {
  std::uint32_t a, b;  // faces of the two soups
  friend auto operator<=>(const FacePair&, const FacePair&) = default;
};

// The queries of tree_query.hpp on wide trees: the same answers. Eight boxes against eight, then eight triangles
// against eight, in binary32 with room for all of its rounding; what is left unsure goes to the exact test. Which
// vector instructions run is found at run time; no answer, and no counter, depends on it.
//
// An object keeps its memory, so that a query like one before allocates nothing. Not thread-safe.
class WideQuery {
 public:
  // Finds one true pair: the first in the order of the trees; false where there is none. `leaf_pair` receives the
  // leaves that it is in.
  struct LeafPair {
    WideTree::ChildSlot a = 0, b = 0;
  };
  [[nodiscard]] bool find_pair(WideTree& a, WideTree& b, const RelativeMotion& a_from_b, PolygonPair& pair,
                               LeafPair* leaf_pair = nullptr);
  // Whether two trees touch in the leaves where they did before, or below the parents of those. Where true, `leaf_pair`
  // receives the leaves; false says nothing.
  [[nodiscard]] bool touch_near_leaves(WideTree& a, WideTree& b, const RelativeMotion& a_from_b, LeafPair& leaf_pair);
  // All true pairs, sorted, each once; valid until the next query.
  [[nodiscard]] const std::vector<PolygonPair>& all_pairs(WideTree& a, WideTree& b, const RelativeMotion& a_from_b);

  // True is certain: no point of A is as near as `gap_m` to one of B. False says nothing: the bound is that of boxes
  // and planes, not the distance, and is for meshes that are easily seen to be apart.
  [[nodiscard]] bool separated_by(WideTree& a, WideTree& b, const RelativeMotion& a_from_b, double gap_m);
  // Triangles no farther apart than that, by triangle_distance(), sorted; valid until the next query.
  [[nodiscard]] const std::vector<FacePair>& faces_within(WideTree& a, WideTree& b, const RelativeMotion& a_from_b,
                                                          double distance_m);

  // Whether there are any.
  [[nodiscard]] bool any_within(WideTree& a, WideTree& b, const RelativeMotion& a_from_b, double distance_m);

  [[nodiscard]] const QueryCounters& counters() const { return counters_; }

 private:
  void open(const WideTree& a, const WideTree& b, WideTree::Ref of_a, WideTree::Ref of_b, const WideMotion& motion);
  template <class Leaves>
  bool descend(WideTree& a, WideTree& b, const WideMotion& motion, Leaves leaves);
  template <class Test>
  bool test_triangles(const WideTree& a, const WideTree& b, const WideTree::Leaf& leaf_a, const WideTree::Leaf& leaf_b,
                      const WideMotion& motion, const RelativeMotion& a_from_b, Test test);
  template <class Found>
  bool test_touch(const WideTree& a, const WideTree& b, const WideTree::Leaf& leaf_a, const WideTree::Leaf& leaf_b,
                  const WideMotion& motion, const RelativeMotion& a_from_b, Found found);
  template <class Found>
  bool search(WideTree& a, WideTree& b, const RelativeMotion& a_from_b, Found found);

  std::vector<std::pair<WideTree::ChildSlot, WideTree::ChildSlot>> stack_;  // pairs to visit
  std::vector<PolygonPair> pairs_;
  std::vector<FacePair> faces_;
  QueryCounters counters_;
};

}  // namespace peerd::collision
