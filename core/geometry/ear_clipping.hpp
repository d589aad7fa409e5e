#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/corner_tree.hpp"
#include "core/geometry/plane_point.hpp"

namespace peerd {

// The numbers of the corners of a polygon, 0 .. n - 1, in the order in which the polygon runs.
using CornerTriangle = std::array<std::uint32_t, 3>;

// EarClipping cuts corners off a polygon in a plane until a triangle is left. The result is always n - 2 triangles,
// whose signed areas add up to that of the polygon. Those of a simple polygon have an area > 0 if it has.
//
// The next corner to be cut is, of the polygon that is left,
//   1. the lowest spike: it is where one of its neighbours is, or they lie in one direction from it, so that it bounds
// no area; else
//   2. the lowest ear: a turn to the left, with no other corner in the triangle that would be cut off (see blocks() for
// corners on its boundary); else
//   3. the lowest corner. Polygons that cross themselves come to this.
//
// Simple polygons have an ear with every corner that is left (Meisters 1975: even two). Holes that are joined to the
// outside by a pair of edges, as files have them, make corners meet; the care about boundaries is for them.
class EarClipping {
 public:
  // Cuts a polygon of >= 3 points, which runs to the left as a whole, and appends to `triangles`. The time is about n
  // log n; it is more (n^1.4 is measured for stars with thin rays) where many narrow triangles cross each other, and
  // O(n^2) at worst.
  void cut(std::span<const PlanePoint> points, std::vector<CornerTriangle>& triangles);

 private:
  enum class Kind : std::uint8_t { kSpike, kEar, kBlocked, kOther, kCut };
  struct Corner {
    std::uint32_t previous = 0, next = 0;                    // neighbours in the polygon that is left
    std::uint32_t previous_distinct = 0, next_distinct = 0;  // nearest corners of the whole polygon at another point
    std::uint32_t searched_until = 0;                        // place in tree_; all before it don't block
    std::uint32_t blocker = kNone;                           // the last one that did; it knows who waits for it
    std::uint32_t first_blocked = kNone;                     // entry of waiting_ for who is blocked by this corner
    Kind kind = Kind::kOther;
  };
  struct BlockedCorner {
    std::uint32_t corner, next_entry;
  };
  static constexpr std::uint32_t kNone = 0xffff'ffff;

  void link();
  void classify(std::uint32_t i);
  void find_blocker(std::uint32_t i);
  [[nodiscard]] bool blocks(std::uint32_t i, std::uint32_t j) const;
  void remove(std::uint32_t i);
  void push_candidate(Kind kind, std::uint32_t i);
  [[nodiscard]] std::uint32_t take_next();

  std::span<const PlanePoint> points_;
  // The arrays are kept from call to call for their memory.
  std::vector<Corner> corners_;
  CornerTree tree_;                             // the corners that are left
  std::vector<BlockedCorner> blocked_corners_;  // lists
  std::vector<std::uint64_t> candidates_;       // heap of spikes and ears, the best on top; some are stale
  std::uint32_t lowest_ = 0;                    // no corner below it is left
};

}  // namespace peerd
