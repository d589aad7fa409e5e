#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "collision/engines/vertex_realignment.hpp"
#include "collision/query/tree_query.hpp"
#include "collision/scene/narrow_phase.hpp"

namespace peerd::collision::engines {

// The hierarchies of the thesis's chapter 3 (KdopTree), built as far as queries go, or whole.
template <int K>
class KdopQuery : public NarrowPhase {
 public:
  // `whole`: a tree is built to its leaves when a question first needs it.
  explicit KdopQuery(const TreeOptions& options, bool whole = false, RealignBy realign = RealignBy::kSlabs)
      : options_(options), whole_(whole), realign_(realign) {}

  bool find_pair(const NumberedSoup& a, const NumberedSoup& b, const RelativeMotion& a_from_b,
                 PolygonPair& pair) override {
    drop_old_trees();
    Kept &of_a = kept(a), &of_b = kept(b);
    if (realign_ == RealignBy::kSlabs) {
      return collision::find_pair(of_a.tree, of_b.tree, a_from_b, counters_, pair);
    }
    return find_pair_by(of_a.tree, of_b.tree, a_from_b, counters_, by_vertices(of_b, a_from_b), pair);
  }
  std::vector<PolygonPair> all_pairs(const NumberedSoup& a, const NumberedSoup& b,
                                     const RelativeMotion& a_from_b) override {
    drop_old_trees();
    Kept &of_a = kept(a), &of_b = kept(b);
    if (realign_ == RealignBy::kSlabs) return collision::all_pairs(of_a.tree, of_b.tree, a_from_b, counters_);
    return all_pairs_by(of_a.tree, of_b.tree, a_from_b, counters_, by_vertices(of_b, a_from_b));
  }
  [[nodiscard]] const QueryCounters& counters() const override { return counters_; }

 private:
  struct Kept {
    KdopTree<K> tree;
    NodeVertices<K> vertices;
    Kept(const TriangleSoup& soup, const TreeOptions& options, RealignBy realign)
        : tree(soup, options), vertices(tree, realign) {}
    Kept(const Kept&) = delete;
    Kept& operator=(const Kept&) = delete;
  };

  // Soups whose vertices move get a new number each time; the trees of old ones are dropped together.
  static constexpr std::size_t kTreesMax = 4096;
  void drop_old_trees() {
    if (trees_.size() >= kTreesMax) trees_.clear();
  }
  Kept& kept(const NumberedSoup& of) {
    const auto [at, is_new] = trees_.try_emplace(of.number, *of.soup, options_, realign_);
    if (is_new && whole_) at->second.tree.build_all();
    return at->second;
  }
  static auto by_vertices(Kept& b, const RelativeMotion& a_from_b) {
    return [&b, &a_from_b](std::uint32_t node) { return b.vertices.realigned(node, a_from_b); };
  }

  TreeOptions options_;
  bool whole_;
  RealignBy realign_;
  std::map<std::uint64_t, Kept> trees_;  // by a soup's number
  QueryCounters counters_;
};

}  // namespace peerd::collision::engines
