#pragma once
#include <compare>
#include <cstdint>

namespace peerd::collision {

// Objects here have dense indices, which the caller gives out and may reuse once they were removed.
using BroadIndex = std::uint32_t;
using BroadGroup = std::uint32_t;  // dense, too

struct BroadPair {
  BroadIndex low = 0, high = 0;  // low < high
  [[nodiscard]] std::uint64_t key() const { return std::uint64_t{low} << 32 | high; }
  friend bool operator==(BroadPair a, BroadPair b) { return a.key() == b.key(); }
  friend auto operator<=>(BroadPair a, BroadPair b) { return a.key() <=> b.key(); }
};
[[nodiscard]] inline BroadPair make_broad_pair(BroadIndex a, BroadIndex b) {
  return a < b ? BroadPair{a, b} : BroadPair{b, a};
}

}  // namespace peerd::collision
