#include "collision/tree/binned_split.hpp"

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
constexpr std::uint32_t kFewItems = 64;  // ranges of no more have half the bins

// A face's bits make a number of ordinary size, with which arithmetic costs nothing.
constexpr std::uint32_t kOrdinary = 0x4000'0000;

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

  explicit Binning(const SplitRange& range) : bins(range.count() <= kFewItems ? kMostBins / 2 : kMostBins) {
    first = -range.twice_middles.minus_lo;
    for (std::size_t k = 0; k < 3; ++k) {
      const float s = (static_cast<float>(bins) * 0.99999f) / (range.twice_middles.hi[k] - first[k]);
      scale[k] = std::isfinite(s) ? s : 0.0f;
      if (scale[k] != 0.0f && (scale[longest] == 0.0f || scale[k] < scale[longest])) longest = k;
    }
    scale[3] = 0.0f;
    if (range.count() > kManyItems) {
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

// Returns the cut whose cost is least.
Cut cheapest(const SplitBins& bins, const Binning& binning, std::uint32_t count) {
  const auto cost = [](const Bounds4& bounds, std::uint32_t n) {
    const std::uint32_t leaves = (n + kLeafSize - 1) / kLeafSize;
    return bounds.half_area() * static_cast<float>(leaves);
  };
  Cut cut;
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    if (binning.scale[k] == 0.0f) continue;
    std::array<float, kMostBins> right{};
    Bounds4 sum;
    std::uint32_t n = 0;
    for (std::size_t i = binning.bins - 1; i > 0; --i) {
      sum.merge(bins[i][k].bounds());
      n += bins[i][k].count;
      if (n > 0) right[i] = cost(sum, n);
    }
    sum = {};
    n = 0;
    for (std::size_t i = 1; i < binning.bins; ++i) {
      sum.merge(bins[i - 1][k].bounds());
      n += bins[i - 1][k].count;
      if (n == 0 || n == count) continue;
      const float both = cost(sum, n) + right[i];
      if (both < least) {
        least = both;
        cut = {k, i};
      }
    }
  }
  return cut;
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
  // The bins of the other axes take two of three items, so that none waits for the one before.
  const std::size_t k = binning.longest;
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

// Puts the items of the left half before those of the right one.
template <int kAxis>
void divide(std::span<SplitItem> items, const Binning& binning, int bin, SplitHalves& halves) {
  while (halves.left.end < halves.right.begin) {
    SplitItem& item = items[halves.left.end];
    if (binning(item)[kAxis] < bin) {
      halves.left.twice_middles.merge(item.twice_middle());
      ++halves.left.end;
    } else {
      halves.right.twice_middles.merge(item.twice_middle());
      std::swap(item, items[--halves.right.begin]);
    }
  }
}

}  // namespace

SplitItem::SplitItem(const Bounds4& bounds, std::uint32_t face) : minus_lo_(bounds.minus_lo), hi_(bounds.hi) {
  assert(face < kOrdinary);
  minus_lo_[3] = std::bit_cast<float>(face | kOrdinary);
  hi_[3] = 0.0f;
}

std::uint32_t SplitItem::face() const { return std::bit_cast<std::array<std::uint32_t, 4>>(minus_lo_)[3] & ~kOrdinary; }

SplitRange measured(std::span<const SplitItem> items, std::uint32_t begin, std::uint32_t end) {
  assert(begin < end && end <= items.size());
  SplitRange range{begin, end, {}, {}};
  for (std::uint32_t i = begin; i < end; ++i) {
    range.bounds.merge(items[i].bounds());
    range.twice_middles.merge(items[i].twice_middle());
  }
  return range;
}

SplitHalves split(std::span<SplitItem> items, const SplitRange& range) {
  assert(range.count() >= 2);
  const Binning binning(range);
  SplitBins bins;
  fill(items.subspan(range.begin, range.count()), binning, bins);
  const Cut cut = cheapest(bins, binning, range.count());
  if (cut.axis == 3) {  // all middles are one, or too far apart for binary32
    const std::uint32_t leaves = (range.count() + kLeafSize - 1) / kLeafSize;
    const std::uint32_t middle = range.begin + (leaves > 1 ? leaves / 2 * kLeafSize : range.count() / 2);
    return {measured(items, range.begin, middle), measured(items, middle, range.end)};
  }
  SplitHalves halves{{range.begin, range.begin, {}, {}}, {range.end, range.end, {}, {}}};
  for (std::size_t i = 0; i < binning.bins; ++i) {
    (i < cut.bin ? halves.left : halves.right).bounds.merge(bins[i][cut.axis].bounds());
  }
  const auto bin = static_cast<int>(cut.bin);
  if (cut.axis == 0) divide<0>(items, binning, bin, halves);
  if (cut.axis == 1) divide<1>(items, binning, bin, halves);
  if (cut.axis == 2) divide<2>(items, binning, bin, halves);
  assert(halves.left.count() > 0 && halves.right.count() > 0);
  return halves;
}

}  // namespace peerd::collision
