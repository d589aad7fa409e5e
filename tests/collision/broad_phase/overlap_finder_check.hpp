#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "collision/broad_phase/overlap_finder.hpp"
#include "tests/collision/soups.hpp"

namespace peerd::collision::test {

using IndexPairs = std::set<std::pair<BroadIndex, BroadIndex>>;

// All pairs of members whose boxes overlap, every one against every one.
inline IndexPairs overlapping(const std::vector<FatBox>& boxes, const std::set<BroadIndex>& members) {
  IndexPairs pairs;
  for (const BroadIndex a : members) {
    for (const BroadIndex b : members) {
      if (a < b && overlap(boxes[a], boxes[b])) pairs.emplace(a, b);
    }
  }
  return pairs;
}

// Boxes that move, grow, vanish and come back, members that come and go: after each update, all overlaps that are new
// were found, and nothing that does not overlap.
template <class Finder>
void expect_finds_new_overlaps(std::uint64_t seed, std::size_t most_changes) {
  constexpr BroadIndex kObjects = 60;
  Numbers numbers(seed);
  std::vector<FatBox> boxes(kObjects, FatBox::none());
  Finder finder(boxes);
  std::set<BroadIndex> members;
  IndexPairs before;
  std::size_t found_in_all = 0;
  for (int round = 0; round < 120; ++round) {
    std::set<BroadIndex> changed;
    const auto changes = 1 + static_cast<std::size_t>(numbers.unit() * static_cast<double>(most_changes));
    for (std::size_t n = 0; n < changes; ++n) {
      const auto object = static_cast<BroadIndex>(numbers.unit() * kObjects);
      if (!members.contains(object)) {
        finder.insert(object);
        members.insert(object);
      } else if (numbers.unit() < 0.1) {
        finder.erase(object);
        members.erase(object);
        changed.erase(object);
        std::erase_if(before, [&](const auto& p) { return p.first == object || p.second == object; });
        continue;
      }
      const Vec3 center = numbers.point(2.0);
      const double half = numbers.unit() < 0.05 ? 3.0 : numbers.between(0.0, 0.6);
      boxes[object] = numbers.unit() < 0.1
                          ? FatBox::none()
                          : fattened(ExactBox::of({center - Vec3::Constant(half), center + Vec3::Constant(half)}), 0.0);
      changed.insert(object);
    }
    std::vector<OverlapFinder::Found> found;
    finder.update(std::vector<BroadIndex>(changed.begin(), changed.end()), found);
    const IndexPairs now = overlapping(boxes, members);
    IndexPairs named;
    for (const auto& f : found) named.insert(std::minmax(f.changed, f.other));
    ASSERT_TRUE(std::ranges::includes(now, named)) << round;
    IndexPairs fresh;
    std::ranges::set_difference(now, before, std::inserter(fresh, fresh.end()));
    ASSERT_TRUE(std::ranges::includes(named, fresh)) << round;
    found_in_all += fresh.size();
    before = now;
  }
  EXPECT_GT(found_in_all, 500u);
}

}  // namespace peerd::collision::test
