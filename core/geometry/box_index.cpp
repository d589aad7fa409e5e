#include "core/geometry/box_index.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace peerd {
namespace {

// Cells are no narrower than 2^kLeast m, and a box that is wider than 2^kMost m, or farther away than 2^kFarthest
// cells, is in no cell.
constexpr int kLeast = -10, kMost = 30;
constexpr double kFarthest = 0x1p52;

}  // namespace

bool BoxIndex::range_of(const Vec3& low, const Vec3& high, int level, const Grid& grid, CellRange& range) {
  double cells = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double first = std::floor(std::ldexp(low[axis] - grid.half_m, -level));
    const double last = std::floor(std::ldexp(high[axis] + grid.half_m, -level));
    cells *= last - first + 1.0;
    if (!(cells <= static_cast<double>(grid.slots.size())) || std::abs(first) > kFarthest ||
        std::abs(last) > kFarthest) {
      return false;
    }
    range.first[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(first);
    range.last[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(last);
  }
  return true;
}

void BoxIndex::rehash(Grid& grid) {
  std::size_t with_boxes = 0;
  for (const CellSlot& slot : grid.slots) with_boxes += slot.first != kNone ? 1 : 0;
  std::size_t size = 16;
  while (size < 4 * (with_boxes + 1)) size *= 2;
  const std::vector<CellSlot> before = std::exchange(grid.slots, std::vector<CellSlot>(size));
  grid.used = with_boxes;
  for (const CellSlot& slot : before) {
    if (slot.first != kNone) grid.slots[slot_of(grid, slot.cell)] = slot;
  }
}

void BoxIndex::set(std::uint32_t number, const Vec3& low, const Vec3& high) {
  assert(number < kNone);
  if (number >= entries_.size()) entries_.resize(number + std::size_t{1});
  if (entries_[number].level != kAbsent) erase(number);
  Entry& entry = entries_[number];
  entry.low = low;
  entry.high = high;
  ++size_;
  const Vec3 center = 0.5 * low + 0.5 * high;
  const double half_m = 0.5 * (high - low).maxCoeff();
  int level = kLeast;
  if (half_m > std::ldexp(1.0, kLeast)) std::frexp(half_m, &level);
  const bool fits = low.allFinite() && high.allFinite() && level <= kMost &&
                    center.cwiseAbs().maxCoeff() < std::ldexp(kFarthest, level);
  if (!fits) {
    entry.level = kEverywhere;
    everywhere_.push_back(number);
    return;
  }
  for (int axis = 0; axis < 3; ++axis) {
    entry.cell[static_cast<std::size_t>(axis)] =
        static_cast<std::int64_t>(std::floor(std::ldexp(center[axis], -level)));
  }
  entry.level = level;
  Grid& grid = grids_[level];
  // The centre is rounded, so that the box may reach a little farther.
  grid.half_m = std::max(grid.half_m, half_m + 0x1p-50 * (half_m + center.cwiseAbs().maxCoeff()));
  ++grid.boxes;
  if (2 * (grid.used + 1) > grid.slots.size()) rehash(grid);
  CellSlot& slot = grid.slots[slot_of(grid, entry.cell)];
  if (!std::exchange(slot.is_used, true)) {
    slot.cell = entry.cell;
    ++grid.used;
  }
  entry.before = kNone;
  entry.next = slot.first;
  if (entry.next != kNone) entries_[entry.next].before = number;
  slot.first = number;
}

void BoxIndex::erase(std::uint32_t number) {
  assert(number < entries_.size() && entries_[number].level != kAbsent);
  Entry& entry = entries_[number];
  if (entry.level == kEverywhere) {
    std::erase(everywhere_, number);
  } else {
    const auto grid = grids_.find(entry.level);
    if (entry.next != kNone) entries_[entry.next].before = entry.before;
    if (entry.before != kNone) {
      entries_[entry.before].next = entry.next;
    } else {
      grid->second.slots[slot_of(grid->second, entry.cell)].first = entry.next;
    }
    if (--grid->second.boxes == 0) {
      grids_.erase(grid);
    } else if (grid->second.slots.size() > 16 * (grid->second.boxes + 4)) {
      rehash(grid->second);
    }
  }
  entry.level = kAbsent;
  --size_;
}

}  // namespace peerd
