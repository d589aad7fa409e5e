#include "collision/tree/wide_tree.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace peerd::collision {
namespace {

constexpr std::uint32_t kLeafSize = WideTree::kWidth;

// The number of triangles that each full child of a node of `count` triangles holds.
std::uint32_t child_capacity(std::uint32_t count) {
  std::uint32_t capacity = kLeafSize;
  while (static_cast<std::uint64_t>(capacity) * WideTree::kWidth < count) capacity *= WideTree::kWidth;
  return capacity;
}

}  // namespace

void WideTree::measure() {
  origin_ = soup_->box.lo / 2 + soup_->box.hi / 2;
  extent_m_ = 0.0;
  for (int k = 0; k < 3; ++k) {
    extent_m_ = std::max({extent_m_, soup_->box.hi[k] - origin_[k], origin_[k] - soup_->box.lo[k]});
  }
  assert(extent_m_ >= 0.0);
  constexpr double kLargest = 0x1p60;  // far from an overflow even after a few products and sums
  scale_ = extent_m_ <= kLargest ? 1.0 : kLargest * std::exp2(-std::ceil(std::log2(extent_m_)));
}

static_assert(WideTree::kWidth == 8 && sizeof(WideTree::Node) % 32 == 0 && sizeof(WideTree::Leaf) % 32 == 0);
static_assert(alignof(WideTree::Node) == 32 && alignof(WideTree::Leaf) == 32);

WideTree::WideTree(const TriangleSoup& soup, std::shared_ptr<const void> owner, std::span<const Node> nodes,
                   std::span<const Leaf> leaves)
    : soup_(&soup), owner_(std::move(owner)), node_data_(nodes.data()), leaf_data_(leaves.data()) {
  assert(!leaves.empty());
  measure();
  root_ = Ref(nodes.empty() ? Ref::kLeaf : Ref::kNode, 0);
}

WideTree::WideTree(const TriangleSoup& soup) : soup_(&soup) {
  assert(!soup.faces.empty());
  measure();
  items_.reserve(soup.faces.size());
  for (std::uint32_t f = 0; f < soup.faces.size(); ++f) {
    items_.push_back(make_item(f));
  }
  const auto count = static_cast<std::uint32_t>(items_.size());
  leaves_.reserve((count + kLeafSize - 1) / kLeafSize);
  std::size_t nodes = 0;
  for (std::uint64_t full = kLeafSize * kWidth; full / kWidth < count; full *= kWidth)
    nodes += (count + full - 1) / full;
  nodes_.reserve(nodes);
  node_data_ = nodes_.data();
  leaf_data_ = leaves_.data();
  root_ = pending({0, count});
}

WideTree::Ref WideTree::pending(Range range) {
  assert(range.begin < range.end && range.end <= items_.size());
  ranges_.push_back(range);
  return {Ref::kPending, static_cast<std::uint32_t>(ranges_.size() - 1)};
}

WideTree::Ref WideTree::resolve(Ref& ref) {
  if (ref.kind() == Ref::kPending) {
    assert(ref.index() < ranges_.size());
    const Range range = ranges_[ref.index()];
    ref = range.count() <= kLeafSize ? make_leaf(range) : make_node(range);
  }
  return ref;
}

WideTree::Item WideTree::make_item(std::uint32_t face) const {
  const auto& c = soup_->faces[face].corners;
  const Vec3 &p = soup_->vertices[c[0]], &q = soup_->vertices[c[1]], &r = soup_->vertices[c[2]];
  Item item{};
  item.face = face;
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    item.lo[i] = static_cast<float>((std::min({p[k], q[k], r[k]}) - origin_[k]) * scale_);
    item.hi[i] = static_cast<float>((std::max({p[k], q[k], r[k]}) - origin_[k]) * scale_);
  }
  return item;
}

WideTree::Bounds WideTree::bound(Range range) const {
  assert(range.begin < range.end);
  Bounds out{items_[range.begin].lo, items_[range.begin].hi};
  for (std::uint32_t i = range.begin + 1; i < range.end; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      out.lo[k] = items_[i].lo[k] < out.lo[k] ? items_[i].lo[k] : out.lo[k];
      out.hi[k] = items_[i].hi[k] > out.hi[k] ? items_[i].hi[k] : out.hi[k];
    }
  }
  return out;
}

WideTree::Box WideTree::box_of(const Bounds& bounds) {
  Box box{};
  for (std::size_t k = 0; k < 3; ++k) {
    box.center[k] = 0.5f * bounds.lo[k] + 0.5f * bounds.hi[k];
    box.half[k] = std::max(bounds.hi[k] - box.center[k], box.center[k] - bounds.lo[k]);
  }
  return box;
}

// Puts the items that belong before `middle` there. Items are counted by bins first, so that the comparisons, which are
// what costs, are left with one bin. A float's way to its bin keeps order.
void WideTree::divide(Range range, std::uint32_t middle, std::size_t axis, float least, float most) {
  assert(range.begin < middle && middle < range.end);
  constexpr std::uint32_t kBins = 1024;
  const auto slot = [axis](const Item& item) { return item.lo[axis] + item.hi[axis]; };
  const auto before = [slot](const Item& a, const Item& b) {
    return slot(a) != slot(b) ? slot(a) < slot(b) : a.face < b.face;
  };
  auto begin = items_.begin() + range.begin, end = items_.begin() + range.end;
  const float scale = static_cast<float>(kBins) / (most - least);
  if (range.count() >= kBins && scale > 0.0f && std::isfinite(scale)) {
    const auto bin_of = [&](const Item& item) {
      return std::min(kBins - 1, static_cast<std::uint32_t>((slot(item) - least) * scale));
    };
    std::array<std::uint32_t, kBins> counts{};
    for (auto item = begin; item != end; ++item) ++counts[bin_of(*item)];
    std::uint32_t bin = 0, passed = range.begin;
    while (passed + counts[bin] <= middle) passed += counts[bin++];
    begin = std::partition(begin, end, [&](const Item& item) { return bin_of(item) < bin; });
    end = std::partition(begin, end, [&](const Item& item) { return bin_of(item) == bin; });
  }
  std::nth_element(begin, items_.begin() + middle, end, before);
}

// Splits a range in two, by the middles of the triangles' boxes along the axis where those are spread widest; ties by
// the face's number, so that every library's nth_element gives the same halves. Then each half, until each part is one
// child.
void WideTree::split(Range range, std::uint32_t capacity, std::array<Range, kWidth>& parts, std::size_t& count) {
  const std::uint32_t children = (range.count() + capacity - 1) / capacity;
  if (children == 1) {
    assert(count < kWidth && range.count() <= capacity);
    parts[count++] = range;
    return;
  }
  std::array<float, 3> lo, hi;
  lo.fill(std::numeric_limits<float>::infinity());
  hi.fill(-std::numeric_limits<float>::infinity());
  for (std::uint32_t i = range.begin; i < range.end; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const float middle = items_[i].lo[k] + items_[i].hi[k];
      lo[k] = middle < lo[k] ? middle : lo[k];
      hi[k] = middle > hi[k] ? middle : hi[k];
    }
  }
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (hi[k] - lo[k] > hi[axis] - lo[axis]) axis = k;
  }
  const std::uint32_t middle = range.begin + children / 2 * capacity;
  divide(range, middle, axis, lo[axis], hi[axis]);
  split({range.begin, middle}, capacity, parts, count);
  split({middle, range.end}, capacity, parts, count);
}

WideTree::Ref WideTree::make_node(Range range) {
  std::array<Range, kWidth> parts{};
  std::size_t count = 0;
  split(range, child_capacity(range.count()), parts, count);
  assert(nodes_.size() < nodes_.capacity());
  assert(count >= 2 && count <= kWidth);
  Node& node = nodes_.emplace_back();
  for (std::size_t k = 0; k < 3; ++k) {
    node.center[k].fill(0.0f);
    node.half[k].fill(kNoBox);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Box box = box_of(bound(parts[i]));
    for (std::size_t k = 0; k < 3; ++k) {
      node.center[k][i] = box.center[k];
      node.half[k][i] = box.half[k];
    }
    node.children[i] = pending(parts[i]);
  }
  return {Ref::kNode, static_cast<std::uint32_t>(nodes_.size() - 1)};
}

WideTree::Ref WideTree::make_leaf(Range range) {
  assert(leaves_.size() < leaves_.capacity());
  assert(range.count() >= 1 && range.count() <= kLeafSize);
  std::ranges::sort(items_.begin() + range.begin, items_.begin() + range.end, {}, &Item::face);
  Leaf& leaf = leaves_.emplace_back();
  const Box box = box_of(bound(range));
  leaf.center = box.center;
  leaf.half = box.half;
  leaf.count = range.count();
  for (std::size_t i = 0; i < kWidth; ++i) {
    // Lanes beyond the last repeat it; count says that they are none.
    leaf.faces[i] = items_[std::min(range.begin + static_cast<std::uint32_t>(i), range.end - 1)].face;
  }
  fill_corners(leaf);
  return {Ref::kLeaf, static_cast<std::uint32_t>(leaves_.size() - 1)};
}

void WideTree::fill_corners(Leaf& leaf) const {
  for (std::size_t i = 0; i < kWidth; ++i) {
    const auto& corners = soup_->faces[leaf.faces[i]].corners;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3 p = (soup_->vertices[corners[c]] - origin_) * scale_;
      for (std::size_t k = 0; k < 3; ++k) leaf.corners[c][k][i] = static_cast<float>(p[static_cast<int>(k)]);
    }
  }
}

// The bounds of a node or leaf whose own boxes are up to date.
WideTree::Bounds WideTree::bound(Ref ref) const {
  if (ref.kind() == Ref::kPending) return bound(ranges_[ref.index()]);
  Bounds out;
  out.lo.fill(std::numeric_limits<float>::infinity());
  out.hi.fill(-std::numeric_limits<float>::infinity());
  for (std::size_t k = 0; k < 3; ++k) {
    if (ref.kind() == Ref::kLeaf) {
      for (const auto& corner : leaves_[ref.index()].corners) {
        out.lo[k] = std::min(out.lo[k], *std::ranges::min_element(corner[k]));
        out.hi[k] = std::max(out.hi[k], *std::ranges::max_element(corner[k]));
      }
      continue;
    }
    const Node& node = nodes_[ref.index()];
    for (std::size_t i = 0; i < kWidth; ++i) {
      if (node.children[i].kind() == Ref::kNone) continue;
      out.lo[k] = std::min(out.lo[k], node.center[k][i] - node.half[k][i]);
      out.hi[k] = std::max(out.hi[k], node.center[k][i] + node.half[k][i]);
    }
  }
  return out;
}

void WideTree::refit() {
  assert(owner_ == nullptr);
  measure();
  for (Item& item : items_) item = make_item(item.face);
  for (std::uint32_t i = 0; i < leaves_.size(); ++i) {
    fill_corners(leaves_[i]);
    const Box box = box_of(bound(Ref(Ref::kLeaf, i)));
    leaves_[i].center = box.center;
    leaves_[i].half = box.half;
  }
  for (std::size_t n = nodes_.size(); n-- > 0;) {  // children stand behind their parents
    for (std::size_t i = 0; i < kWidth; ++i) {
      if (nodes_[n].children[i].kind() == Ref::kNone) continue;
      const Box box = box_of(bound(nodes_[n].children[i]));
      for (std::size_t k = 0; k < 3; ++k) {
        nodes_[n].center[k][i] = box.center[k];
        nodes_[n].half[k][i] = box.half[k];
      }
    }
  }
}

void WideTree::build_all() {
  (void)at(kRoot);
  for (std::uint32_t n = 0; n < nodes_.size(); ++n) {
    for (Ref& ref : nodes_[n].children) (void)resolve(ref);
  }
  assert(std::ranges::all_of(nodes_, [](const Node& n) { return n.children[0].kind() <= Ref::kLeaf; }));
  items_ = {};
  ranges_ = {};
}

std::size_t WideTree::memory_bytes() const {
  return nodes_.capacity() * sizeof(Node) + leaves_.capacity() * sizeof(Leaf) + items_.capacity() * sizeof(Item) +
         ranges_.capacity() * sizeof(Range);
}

}  // namespace peerd::collision
