#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "collision/engines/visited_pairs.hpp"
#include "collision/engines/volume_tree.hpp"
#include "collision/exact/triangle_pair.hpp"
#include "collision/scene/narrow_phase.hpp"

namespace peerd::collision::engines {

// A NarrowPhase by VolumeTrees, descended as RAPID does: of two nodes that overlap the larger one is opened.
//
// A Volume has, besides what a VolumeTree asks of it,
//   Test                    what is computed once for a pair of objects, of (RelativeMotion, extent of A, extent of B)
//   test(a, b) -> bool      of a Test: false means that the volumes are certainly apart
//   size()                  by which the larger one is found
// Leaves that overlap are left to the exact test.
template <class Volume>
class VolumeQuery : public NarrowPhase {
 public:
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
  using Tree = VolumeTree<Volume>;

  // Soups whose vertices move get a new number each time; the trees of old ones are dropped together.
  static constexpr std::size_t kTreesMax = 4096;

  const Tree& tree(const NumberedSoup& of) { return trees_.try_emplace(of.number, *of.soup).first->second; }

  // Visits pairs of polygons until `found` returns true, and returns whether it did.
  template <class Found>
  bool search(const NumberedSoup& numbered_a, const NumberedSoup& numbered_b, const RelativeMotion& a_from_b,
              Found found) {
    if (trees_.size() >= kTreesMax) trees_.clear();
    const Tree &a = tree(numbered_a), &b = tree(numbered_b);
    const typename Volume::Test test(a_from_b, largest_coordinate(a.soup().box), largest_coordinate(b.soup().box));
    stack_.assign(1, {0, 0});
    while (!stack_.empty()) {
      const auto [i, j] = stack_.back();
      stack_.pop_back();
      const auto &of_a = a.nodes()[i], &of_b = b.nodes()[j];
      ++counters_.bv_tests;
      if (!test(of_a.volume, of_b.volume)) continue;
      if (of_a.left == 0 && of_b.left == 0) {
        if (touch_leaves(a, b, a.face(of_a), b.face(of_b), a_from_b, found)) return true;
        continue;
      }
      const bool opens_a = of_b.left == 0 || (of_a.left != 0 && of_a.volume.size() >= of_b.volume.size());
      for (const std::uint32_t k : {1u, 0u}) {
        stack_.push_back(opens_a ? std::pair(of_a.left + k, j) : std::pair(i, of_b.left + k));
      }
    }
    return false;
  }

  template <class Found>
  bool touch_leaves(const Tree& a, const Tree& b, std::uint32_t i, std::uint32_t j, const RelativeMotion& a_from_b,
                    Found found) {
    const Triangle of_b = b.soup().triangle(j);
    const Triangle moved = {a_from_b(of_b[0]), a_from_b(of_b[1]), a_from_b(of_b[2])};
    ++counters_.triangle_tests;
    if (!touch(a.soup().triangle(i), moved, counters_.orientation)) return false;
    return found(PolygonPair{a.soup().faces[i].polygon, b.soup().faces[j].polygon});
  }

  std::map<std::uint64_t, Tree> trees_;  // by a soup's number
  std::vector<std::pair<std::uint32_t, std::uint32_t>> stack_;
  QueryCounters counters_;
};

}  // namespace peerd::collision::engines
