#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "collision/query/tree_query.hpp"
#include "collision/scene/narrow_phase.hpp"

namespace peerd::collision::baselines {

// The hierarchies of the thesis's chapter 3 (KdopTree), built as far as queries go, or whole.
template <int K>
class KdopQuery : public NarrowPhase {
 public:
  // `whole`: a tree is built to its leaves when a question first needs it.
  KdopQuery(const TreeOptions& options, bool whole) : options_(options), whole_(whole) {}

  bool find_pair(const NumberedSoup& a, const NumberedSoup& b, const RelativeMotion& a_from_b,
                 PolygonPair& pair) override {
    drop_old_trees();
    return collision::find_pair(tree(a), tree(b), a_from_b, counters_, pair);
  }
  std::vector<PolygonPair> all_pairs(const NumberedSoup& a, const NumberedSoup& b,
                                     const RelativeMotion& a_from_b) override {
    drop_old_trees();
    return collision::all_pairs(tree(a), tree(b), a_from_b, counters_);
  }
  [[nodiscard]] const QueryCounters& counters() const override { return counters_; }

 private:
  // Soups whose vertices move get a new number each time; the trees of old ones are dropped together.
  static constexpr std::size_t kTreesMax = 4096;
  void drop_old_trees() {
    if (trees_.size() >= kTreesMax) trees_.clear();
  }
  KdopTree<K>& tree(const NumberedSoup& of) {
    const auto [at, is_new] = trees_.try_emplace(of.number, *of.soup, options_);
    if (is_new && whole_) at->second.build_all();
    return at->second;
  }

  TreeOptions options_;
  bool whole_;
  std::map<std::uint64_t, KdopTree<K>> trees_;  // by a soup's number
  QueryCounters counters_;
};

}  // namespace peerd::collision::baselines
