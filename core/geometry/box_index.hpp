#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include "core/math.hpp"

namespace peerd {

// Finds which of many boxes may overlap a box [m]. It is a loose hierarchical grid: each box is in one cell, that of
// its centre, of the grid whose cells are about as wide as the box (Ericson 2005, Real-Time Collision Detection, 7.2).
class BoxIndex {
 public:
  // Puts a box of that number in, or in another place. Its sides may be infinite.
  void set(std::uint32_t number, const Vec3& low, const Vec3& high);
  // Takes out the box of that number, which is there.
  void erase(std::uint32_t number);
  [[nodiscard]] std::size_t size() const { return size_; }

  // Calls `function(number)` for each box that overlaps this one or touches it, in an order that depends on what has
  // been set and erased before. `function` must not change the index.
  template <class Function>
  void for_each_near(const Vec3& low, const Vec3& high, Function function) const {
    const auto offer = [&](std::uint32_t number) {
      const Entry& entry = entries_[number];
      for (int axis = 0; axis < 3; ++axis) {
        if (entry.low[axis] > high[axis] || low[axis] > entry.high[axis]) return;
      }
      function(number);
    };
    for (const std::uint32_t number : everywhere_) offer(number);
    for (const auto& [level, grid] : grids_) {
      CellRange range;
      if (!range_of(low, high, level, grid, range)) {  // there are more cells than slots
        for (const CellSlot& slot : grid.slots) offer_list(slot.first, offer);
        continue;
      }
      for (std::int64_t x = range.first[0]; x <= range.last[0]; ++x) {
        for (std::int64_t y = range.first[1]; y <= range.last[1]; ++y) {
          for (std::int64_t z = range.first[2]; z <= range.last[2]; ++z) {
            offer_list(grid.slots[slot_of(grid, {x, y, z})].first, offer);
          }
        }
      }
    }
  }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  using Cell = std::array<std::int64_t, 3>;
  // A cell with boxes, or one that had some; cells are in a hash table with linear probing.
  struct CellSlot {
    Cell cell{};
    std::uint32_t first = kNone;  // the number of a box in it, which leads to the others
    bool is_used = false;
  };
  struct Grid {
    std::vector<CellSlot> slots;  // a power of two of them, of which at most half are used
    std::size_t used = 0;
    std::size_t boxes = 0;
    double half_m = 0.0;  // no box here ends farther from its centre
  };
  struct CellRange {
    Cell first, last;
  };
  // kAbsent: the number is not in the index; kEverywhere: its box is in no cell.
  static constexpr int kAbsent = -10'000, kEverywhere = -9'999;
  struct Entry {
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
    std::uint32_t next = kNone, before = kNone;  // in its cell
    int level = kAbsent;
    Cell cell{};
  };

  template <class Offer>
  void offer_list(std::uint32_t first, Offer offer) const {
    for (std::uint32_t number = first; number != kNone; number = entries_[number].next) offer(number);
  }
  // The slot of a cell, or the unused one where it belongs.
  [[nodiscard]] static std::size_t slot_of(const Grid& grid, const Cell& cell) {
    std::uint64_t hash = 0;
    for (const std::int64_t each : cell) {
      hash = (hash ^ static_cast<std::uint64_t>(each)) * 0x9E3779B97F4A7C15ULL;
      hash ^= hash >> 32;
    }
    const std::size_t mask = grid.slots.size() - 1;
    std::size_t i = hash & mask;
    while (grid.slots[i].is_used && grid.slots[i].cell != cell) i = (i + 1) & mask;
    return i;
  }
  // Gives the table room for twice the cells that have boxes, and forgets the others.
  static void rehash(Grid& grid);
  // Sets `range` to the cells of boxes that may be near. Returns false where to go through all slots is less work.
  [[nodiscard]] static bool range_of(const Vec3& low, const Vec3& high, int level, const Grid& grid, CellRange& range);

  std::vector<Entry> entries_;             // by number
  std::vector<std::uint32_t> everywhere_;  // the numbers of boxes that are in no cell
  std::map<int, Grid> grids_;              // by the binary logarithm of the width of their cells
  std::size_t size_ = 0;
};

}  // namespace peerd
