#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include "collision/engines/sphere_volume.hpp"
#include "collision/engines/visited_pairs.hpp"
#include "collision/engines/volume_tree.hpp"
#include "collision/scene/narrow_phase.hpp"

namespace peerd::collision::engines {

// Hubbard's sphere trees (ACM Transactions on Graphics 15(3), 1996), descended level by level in both trees at once:
// the pairs of spheres of level n + 1 are the children of those of level n that overlap. His refinement is interrupted
// when the time is up, and the spheres of the level that it has reached answer; so that runs repeat, it ends here at a
// given level. The answer at one level takes at least as much for a touch as the one at the next, for each pair of a
// level has its parents' pair above it. A sphere of several triangles is named by the first of their polygons.
class SphereQuery : public NarrowPhase {
 public:
  static constexpr std::uint32_t kNoLimit = std::numeric_limits<std::uint32_t>::max();

  // `depth`: the last level, 0 being that of the roots; kNoLimit: down to the leaves.
  explicit SphereQuery(std::uint32_t depth = kNoLimit) : depth_(depth) {}

  bool find_pair(const NumberedSoup& a, const NumberedSoup& b, const RelativeMotion& a_from_b,
                 PolygonPair& pair) override {
    return first_visited([&](auto found) { return search(a, b, a_from_b, found); }, pair);
  }

  std::vector<PolygonPair> all_pairs(const NumberedSoup& a, const NumberedSoup& b,
                                     const RelativeMotion& a_from_b) override {
    return all_visited([&](auto found) { return search(a, b, a_from_b, found); });
  }

  [[nodiscard]] const QueryCounters& counters() const override { return counters_; }

 private:
  using Tree = VolumeTree<Sphere>;
  struct Visit {
    std::uint32_t a = 0, b = 0, level = 0;
  };

  // Soups whose vertices move get a new number each time; the trees of old ones are dropped together.
  static constexpr std::size_t kTreesMax = 4096;

  const Tree& tree(const NumberedSoup& of) { return trees_.try_emplace(of.number, *of.soup).first->second; }

  [[nodiscard]] static std::uint32_t polygon_of(const Tree& tree, const Tree::Node& node) {
    std::uint32_t first = std::numeric_limits<std::uint32_t>::max();
    for (const std::uint32_t face : tree.faces(node)) first = std::min(first, tree.soup().faces[face].polygon);
    return first;
  }

  // Visits pairs of polygons until `found` returns true, and returns whether it did.
  template <class Found>
  bool search(const NumberedSoup& numbered_a, const NumberedSoup& numbered_b, const RelativeMotion& a_from_b,
              Found found) {
    if (trees_.size() >= kTreesMax) trees_.clear();
    const Tree &a = tree(numbered_a), &b = tree(numbered_b);
    const Sphere::Test test(a_from_b, largest_coordinate(a.soup().box), largest_coordinate(b.soup().box));
    stack_.assign(1, Visit{});
    while (!stack_.empty()) {
      const Visit visit = stack_.back();
      stack_.pop_back();
      const Tree::Node &of_a = a.nodes()[visit.a], &of_b = b.nodes()[visit.b];
      ++counters_.bv_tests;
      if (!test(of_a.volume, of_b.volume)) continue;
      if (visit.level == depth_ || (of_a.left == 0 && of_b.left == 0)) {
        if (found(PolygonPair{polygon_of(a, of_a), polygon_of(b, of_b)})) return true;
        continue;
      }
      // A leaf stands for itself in the levels below it.
      for (std::uint32_t i = of_a.left == 0 ? 1 : 2; i-- > 0;) {
        for (std::uint32_t j = of_b.left == 0 ? 1 : 2; j-- > 0;) {
          stack_.push_back(
              {of_a.left == 0 ? visit.a : of_a.left + i, of_b.left == 0 ? visit.b : of_b.left + j, visit.level + 1});
        }
      }
    }
    return false;
  }

  std::uint32_t depth_;
  std::map<std::uint64_t, Tree> trees_;  // by a soup's number
  std::vector<Visit> stack_;
  QueryCounters counters_;
};

}  // namespace peerd::collision::engines
