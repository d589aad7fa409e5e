#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include "collision/tree/oriented_box.hpp"

namespace peerd::collision {

// A triangle on its way to a leaf: its box, and its face's number.
class SplitItem {
 public:
  SplitItem() = default;
  SplitItem(const Bounds4& bounds, std::uint32_t face);
  [[nodiscard]] Bounds4 bounds() const { return {minus_lo_, hi_}; }
  [[nodiscard]] std::uint32_t face() const {
    return std::bit_cast<std::array<std::uint32_t, 4>>(minus_lo_)[3] & ~kOrdinary;
  }
  [[nodiscard]] Float4 twice_middle() const { return hi_ - minus_lo_; }

 private:
  // A face's bits make a number of ordinary size, with which arithmetic costs nothing.
  static constexpr std::uint32_t kOrdinary = 0x4000'0000;

  Float4 minus_lo_, hi_;  // the fourth of the first holds the face
};
static_assert(sizeof(SplitItem) == 32);

// A range of items.
struct SplitRange {
  std::uint32_t begin = 0, end = 0;
  Bounds4 bounds;  // of the items

  [[nodiscard]] std::uint32_t count() const { return end - begin; }
};
[[nodiscard]] SplitRange measured(std::span<const SplitItem> items, std::uint32_t begin, std::uint32_t end);

struct SplitHalves {
  SplitRange left, right;
};
// Splits a range of two items or more where the surface-area heuristic is least between bins of the items' middles,
// along any axis: the half areas of both boxes, times the leaves that each will have at least. The left half's items
// are put before the right half's; within both they keep their order. `spare` has room for the range.
inline constexpr std::uint32_t kLeafSize = 8;
[[nodiscard]] SplitHalves split(std::span<SplitItem> items, std::span<SplitItem> spare, const SplitRange& range);

}  // namespace peerd::collision
