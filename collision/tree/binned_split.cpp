#include "collision/tree/binned_split.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace peerd::collision {
namespace {

using Int4 = int __attribute__((vector_size(16)));
constexpr std::size_t kMostBins = 16;
constexpr std::uint32_t kFewItems = 64;    // ranges of no more have half the bins
constexpr std::uint32_t kManyItems = 512;  // ranges of more are split across the axis of the longest spread alone

struct SplitBin {
  Float4 minus_lo, hi;  // bounds of the items
  std::uint32_t count;

  void clear() {
    minus_lo = hi = Bounds4().hi;
    count = 0;
  }
  [[nodiscard]] Bounds4 bounds() const { return {minus_lo, hi}; }
  void add(const Bounds4& item) {
    minus_lo = max4(minus_lo, item.minus_lo);
    hi = max4(hi, item.hi);
    ++count;
  }
};
// The order is by bin, then axis, so that few bins are few to clear.
using SplitBins = std::array<std::array<SplitBin, 3>, kMostBins>;

// The way from a middle to its bin.
struct Binning {
  std::size_t bins;
  Float4 first, scale;  // a scale of 0: not across this axis
  std::size_t longest = 0;

  explicit Binning(std::span<const SplitItem> items) : bins(items.size() <= kFewItems ? kMostBins / 2 : kMostBins) {
    Bounds4 twice_middles;
    for (const SplitItem& item : items) twice_middles.merge(item.twice_middle());
    first = -twice_middles.minus_lo;
    for (std::size_t k = 0; k < 3; ++k) {
      const float s = (static_cast<float>(bins) * 0.99999f) / (twice_middles.hi[k] - first[k]);
      scale[k] = std::isfinite(s) ? s : 0.0f;
      if (scale[k] != 0.0f && (scale[longest] == 0.0f || scale[k] < scale[longest])) longest = k;
    }
    scale[3] = 0.0f;
    if (items.size() > kManyItems) {
      const Float4 kept = scale;
      scale = Float4{};
      scale[longest] = kept[longest];
    }
  }
  [[nodiscard]] Int4 operator()(const SplitItem& item) const {
    return __builtin_convertvector((item.twice_middle() - first) * scale, Int4);
  }
};

struct Cut {
  std::size_t axis = 3, bin = 0;  // the first bin of the right half; axis 3: there is none
};

// The costs of three boxes, one across each axis, of which each takes a lane.
Float4 costs(const std::array<Bounds4, 3>& boxes, Int4 counts) {
  const Float4 x = boxes[0].sides(), y = boxes[1].sides(), z = boxes[2].sides();
  const Float4 d0{x[0], y[0], z[0], 0.0f}, d1{x[1], y[1], z[1], 0.0f}, d2{x[2], y[2], z[2], 0.0f};
  const Float4 half_areas = (d0 * d1 + d1 * d2) + d2 * d0;
  constexpr int kLeaf = static_cast<int>(kLeafSize);
  const Int4 leaves = (counts + (kLeaf - 1)) / kLeaf;
  return half_areas * __builtin_convertvector(leaves, Float4);
}
void merge(const std::array<SplitBin, 3>& bin, std::array<Bounds4, 3>& boxes, Int4& counts) {
  for (std::size_t k = 0; k < 3; ++k) boxes[k].merge(bin[k].bounds());
  counts += Int4{static_cast<int>(bin[0].count), static_cast<int>(bin[1].count), static_cast<int>(bin[2].count), 0};
}

// Returns the cut whose cost is least.
Cut cheapest(const SplitBins& bins, const Binning& binning, std::uint32_t count) {
  constexpr float kNone = std::numeric_limits<float>::infinity();
  std::array<Float4, kMostBins> right;
  std::array<Bounds4, 3> boxes;
  Int4 counts{};
  for (std::size_t i = binning.bins - 1; i > 0; --i) {
    merge(bins[i], boxes, counts);
    right[i] = costs(boxes, counts);
  }
  boxes = {};
  counts = Int4{};
  Float4 least = all4(kNone);
  Int4 at{};
  const auto all = static_cast<int>(count);
  for (std::size_t i = 1; i < binning.bins; ++i) {
    merge(bins[i - 1], boxes, counts);
    const Float4 both = costs(boxes, counts) + right[i];
    const Int4 better = (counts > 0) & (counts < all) & (both < least);
    least = better ? both : least;
    at = better ? Int4{} + static_cast<int>(i) : at;
  }
  Cut cut;
  float cost = kNone;
  for (std::size_t k = 0; k < 3; ++k) {
    if (binning.scale[k] == 0.0f || !(least[k] < cost)) continue;
    cost = least[k];
    cut = {k, static_cast<std::size_t>(at[k])};
  }
  return cut;
}

// Sorts items to their bins along an axis. The bins of the other axes take two of three items, so that none waits for
// the one before.
template <std::size_t k>
void fill_along(std::span<const SplitItem> items, const Binning& binning, SplitBins& bins) {
  const auto add = [&](const SplitItem& item, std::size_t to) {
    bins[static_cast<std::size_t>(binning(item)[k])][to].add(item.bounds());
  };
  std::size_t i = 0;
  for (; i + 3 <= items.size(); i += 3) add(items[i], 0), add(items[i + 1], 1), add(items[i + 2], 2);
  for (; i < items.size(); ++i) add(items[i], k);
  for (auto& bin : bins) {
    for (const std::size_t from : {(k + 1) % 3, (k + 2) % 3}) {
      bin[k].minus_lo = max4(bin[k].minus_lo, bin[from].minus_lo);
      bin[k].hi = max4(bin[k].hi, bin[from].hi);
      bin[k].count += bin[from].count;
    }
  }
}

// Sorts items to their bins, along three axes or, of many, along the longest.
void fill(std::span<const SplitItem> items, const Binning& binning, SplitBins& bins) {
  for (std::size_t i = 0; i < binning.bins; ++i) {
    for (SplitBin& bin : bins[i]) bin.clear();
  }
  if (items.size() <= kManyItems) {
    for (const SplitItem& item : items) {
      const Int4 bin = binning(item);
      const Bounds4 bounds = item.bounds();
      bins[static_cast<std::size_t>(bin[0])][0].add(bounds);
      bins[static_cast<std::size_t>(bin[1])][1].add(bounds);
      bins[static_cast<std::size_t>(bin[2])][2].add(bounds);
    }
    return;
  }
  if (binning.longest == 0) fill_along<0>(items, binning, bins);
  if (binning.longest == 1) fill_along<1>(items, binning, bins);
  if (binning.longest == 2) fill_along<2>(items, binning, bins);
}

// Puts the items of the left half before those of the right one, and counts them. No branch hangs on where one goes.
template <int kAxis>
std::size_t divide(std::span<SplitItem> items, std::span<SplitItem> spare, const Binning& binning, int bin) {
  std::size_t left = 0, right = 0;
  for (const SplitItem& from : items) {
    const SplitItem item = from;
    const bool goes_left = binning(item)[kAxis] < bin;
    items[left] = spare[right] = item;
    left += goes_left;
    right += !goes_left;
  }
  std::copy_n(spare.begin(), right, items.begin() + static_cast<std::ptrdiff_t>(left));
  return left;
}

}  // namespace

SplitItem::SplitItem(const Bounds4& bounds, std::uint32_t face) : minus_lo_(bounds.minus_lo), hi_(bounds.hi) {
  assert(face < kOrdinary);
  minus_lo_[3] = std::bit_cast<float>(face | kOrdinary);
  hi_[3] = 0.0f;
}

SplitRange measured(std::span<const SplitItem> items, std::uint32_t begin, std::uint32_t end) {
  assert(begin < end && end <= items.size());
  SplitRange range{begin, end, {}};
  for (std::uint32_t i = begin; i < end; ++i) range.bounds.merge(items[i].bounds());
  return range;
}

SplitHalves split(std::span<SplitItem> items, std::span<SplitItem> spare, const SplitRange& range) {
  assert(range.count() >= 2 && spare.size() >= range.count());
  const std::span<SplitItem> of_range = items.subspan(range.begin, range.count());
  SplitBins bins;
  const Binning binning(of_range);
  fill(of_range, binning, bins);
  const Cut cut = cheapest(bins, binning, range.count());
  if (cut.axis == 3) {  // all middles are one, or too far apart for binary32
    const std::uint32_t leaves = (range.count() + kLeafSize - 1) / kLeafSize;
    const std::uint32_t middle = range.begin + (leaves > 1 ? leaves / 2 * kLeafSize : range.count() / 2);
    return {measured(items, range.begin, middle), measured(items, middle, range.end)};
  }
  const auto bin = static_cast<int>(cut.bin);
  const std::size_t left = cut.axis == 0   ? divide<0>(of_range, spare, binning, bin)
                           : cut.axis == 1 ? divide<1>(of_range, spare, binning, bin)
                                           : divide<2>(of_range, spare, binning, bin);
  const std::uint32_t middle = range.begin + static_cast<std::uint32_t>(left);
  SplitHalves halves{{range.begin, middle, {}}, {middle, range.end, {}}};
  for (std::size_t i = 0; i < binning.bins; ++i) {
    (i < cut.bin ? halves.left : halves.right).bounds.merge(bins[i][cut.axis].bounds());
  }
  assert(halves.left.count() > 0 && halves.right.count() > 0);
  return halves;
}

}  // namespace peerd::collision
