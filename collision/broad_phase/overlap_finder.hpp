#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "collision/broad_phase/broad_pair.hpp"
#include "collision/broad_phase/fat_box.hpp"

namespace peerd::collision {

// Finds which fat boxes of its members overlap, among all with all. It is told whose boxes are new and answers with new
// overlaps only; that an overlap is over shows in the pair itself.
class OverlapFinder {
 public:
  struct Found {
    BroadIndex changed, other;
  };
  virtual ~OverlapFinder() = default;

  virtual void insert(BroadIndex object) = 0;  // a member from now on; is `changed` in the next update
  virtual void erase(BroadIndex object) = 0;
  // The boxes of these members may differ, of no others. Appends at least every pair that overlaps now and did not at
  // the last update; of those that overlapped already, any.
  virtual void update(std::span<const BroadIndex> changed, std::vector<Found>& found) = 0;
  [[nodiscard]] std::uint64_t box_tests() const { return box_tests_; }

 protected:
  std::uint64_t box_tests_ = 0;
};

}  // namespace peerd::collision
