#include "collision/tree/wide_tree.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace peerd::collision {
namespace {

static_assert(kLeafSize == WideTree::kWidth);

// The axes of a box around more triangles than twice this are those of this many of them or so.
constexpr std::uint32_t kWeighed = 64;

// The most that a tree of so many triangles can have: only ranges that are too large for a leaf are split, and each
// node but those above leaves alone has eight children.
std::size_t most_leaves(std::size_t triangles) { return triangles <= kLeafSize ? 1 : triangles; }
std::size_t most_nodes(std::size_t triangles) { return triangles <= kLeafSize ? 0 : (triangles - 2) / 7; }

OrientedBox oriented_box(const WideTree::Node& node, std::size_t child) {
  OrientedBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.center[k] = node.oriented_center[k][child];
    box.half[k] = node.oriented_half[k][child];
    for (std::size_t c = 0; c < 3; ++c) box.axes[k][c] = node.axes[k][c][child];
  }
  return box;
}
OrientedBox aligned_box(const WideTree::Node& node, std::size_t child) {
  OrientedBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.center[k] = node.center[k][child];
    box.half[k] = node.half[k][child];
  }
  return box;
}

Bounds4 bounds_of(const std::array<float, 3>& center, const std::array<float, 3>& half) {
  const Float4 c{center[0], center[1], center[2], 0.0f}, h{half[0], half[1], half[2], 0.0f};
  return {h - c, c + h};
}

}  // namespace

WideTree::Node childless_node() {
  WideTree::Node node{};
  for (std::size_t k = 0; k < 3; ++k) {
    node.half[k].fill(WideTree::kNoBox);
    node.oriented_half[k].fill(WideTree::kNoBox);
    node.axes[k][k].fill(1.0f);
  }
  return node;
}
void put_aligned(const OrientedBox& box, WideTree::Node& node, std::size_t child) {
  for (std::size_t k = 0; k < 3; ++k) {
    node.center[k][child] = box.center[k];
    node.half[k][child] = box.half[k];
  }
}
void put_oriented(const OrientedBox& box, WideTree::Node& node, std::size_t child) {
  for (std::size_t k = 0; k < 3; ++k) {
    node.oriented_center[k][child] = box.center[k];
    node.oriented_half[k][child] = box.half[k];
    for (std::size_t c = 0; c < 3; ++c) node.axes[k][c][child] = box.axes[k][c];
  }
}

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

static_assert(WideTree::kWidth == 8 && sizeof(WideTree::Node) % 64 == 0 && sizeof(WideTree::Leaf) % 64 == 0);
static_assert(alignof(WideTree::Node) == 64 && alignof(WideTree::Leaf) == 64);

WideTree::WideTree(const TriangleSoup& soup, std::shared_ptr<const void> owner, std::span<const Node> nodes,
                   std::span<const Leaf> leaves, std::span<const std::uint32_t> faces)
    : soup_(&soup), owner_(std::move(owner)), nodes_(nodes), leaves_(leaves), faces_(faces.data()) {
  assert(!leaves.empty() && faces.size() == soup.faces.size());
  measure();
  root_ = Ref(nodes.empty() ? Ref::kLeaf : Ref::kNode, 0);
  below_.resize(nodes.size());
  for (std::uint32_t n = nodes_.size(); n-- > 0;) {  // children stand behind their parents
    FacesBelow& below = below_[n];
    below = {0, 0, true};
    for (std::size_t i = kWidth; i-- > 0;) {
      const Ref child = nodes_[n].children[i];
      if (child.kind() == Ref::kNone) continue;
      const bool leaf = child.kind() == Ref::kLeaf;
      below.first = leaf ? leaves_[child.index()].first_face : below_[child.index()].first;
      below.count += leaf ? leaves_[child.index()].count : below_[child.index()].count;
    }
  }
}

WideTree::WideTree(const TriangleSoup& soup) : soup_(&soup) {
  assert(!soup.faces.empty());
  measure();
  make_points();
  own_faces_ = std::make_unique_for_overwrite<std::uint32_t[]>(soup.faces.size());
  faces_ = own_faces_.get();
  items_.reserve(soup.faces.size());
  for (std::uint32_t f = 0; f < soup.faces.size(); ++f) items_.push_back(make_item(f));
  root_ = pending(measured(items_, 0, static_cast<std::uint32_t>(items_.size())));
}

void WideTree::make_points() {
  points_.resize(soup_->vertices.size());
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Vec3& v = soup_->vertices[i];
    for (int k = 0; k < 3; ++k) points_[i][k] = static_cast<float>((v[k] - origin_[k]) * scale_);
    points_[i][3] = 0.0f;
  }
}

WideTree::Ref WideTree::pending(const SplitRange& range) {
  assert(range.begin < range.end && range.end <= items_.size());
  ranges_.push_back(range);
  return {Ref::kPending, static_cast<std::uint32_t>(ranges_.size() - 1)};
}

WideTree::Ref WideTree::resolve(ChildSlot slot) {
  const Ref before = peek(slot);
  if (before.kind() != Ref::kPending) return before;
  const SplitRange range = ranges_[before.index()];
  const Ref made = range.count() <= kLeafSize ? make_leaf(range) : make_node(range);
  (slot == kRoot ? root_ : nodes_.at(slot / kWidth).children[slot % kWidth]) = made;
  return made;
}

SplitItem WideTree::make_item(std::uint32_t face) const {
  Bounds4 bounds;
  for (const std::uint32_t corner : soup_->faces[face].corners) bounds.merge(points_[corner]);
  return {bounds, face};
}

// A few of many triangles decide the axes, and where not even those are in a smaller box, none is tried.
OrientedBox WideTree::fitted(const SplitRange& range) const {
  BoxFit fit(range.bounds);
  const auto every = [&](std::uint32_t nth) {
    return [this, &range, nth](auto&& use) {
      for (std::uint32_t i = range.begin; i < range.end; i += nth) {
        const auto& c = soup_->faces[items_[i].face()].corners;
        use(points_[c[0]], points_[c[1]], points_[c[2]]);
      }
    };
  };
  const std::uint32_t step = std::max(1u, range.count() / kWeighed);
  fit.weigh(every(step));
  const OrientedBox aligned = axis_aligned_box(range.bounds);
  if (!fit.turn()) return aligned;
  fit.add(every(step));
  if (step > 1) {
    if (fit.box().half_area() >= aligned.half_area()) return aligned;
    fit.add(every(1));
  }
  return fit.box();
}

// Splits the part with the largest surface, until there are eight or all are leaves.
WideTree::Ref WideTree::make_node(const SplitRange& range) {
  const auto spare = std::make_unique_for_overwrite<SplitItem[]>(range.count());
  std::array<SplitRange, kWidth> parts;
  std::size_t count = 1;
  parts[0] = range;
  while (count < kWidth) {
    std::size_t largest = kWidth;
    for (std::size_t i = 0; i < count; ++i) {
      if (parts[i].count() <= kLeafSize) continue;
      if (largest == kWidth || parts[i].bounds.half_area() > parts[largest].bounds.half_area()) largest = i;
    }
    if (largest == kWidth) break;
    const SplitHalves halves = split(items_, {spare.get(), range.count()}, parts[largest]);
    for (std::size_t i = count; i > largest + 1; --i) parts[i] = parts[i - 1];
    parts[largest] = halves.left;
    parts[largest + 1] = halves.right;
    ++count;
  }
  assert(count >= 2 && count <= kWidth);
  below_.push_back({range.begin, range.count(), false});
  Node& node = nodes_.add(most_nodes(soup_->faces.size()));
  node = childless_node();
  for (std::size_t i = 0; i < count; ++i) {
    put_aligned(axis_aligned_box(parts[i].bounds), node, i);
    put_oriented(fitted(parts[i]), node, i);
    node.children[i] = pending(parts[i]);
  }
  return {Ref::kNode, nodes_.size() - 1};
}

WideTree::Ref WideTree::make_leaf(const SplitRange& range) {
  assert(range.count() >= 1 && range.count() <= kLeafSize);
  // Splits keep the items' order, which is that of the faces.
  assert(std::is_sorted(items_.begin() + range.begin, items_.begin() + range.end,
                        [](const SplitItem& x, const SplitItem& y) { return x.face() < y.face(); }));
  Leaf& leaf = leaves_.add(most_leaves(soup_->faces.size()));
  leaf.first_face = range.begin;
  leaf.count = range.count();
  for (std::uint32_t i = range.begin; i < range.end; ++i) own_faces_[i] = items_[i].face();
  fill_corners(leaf);
  return {Ref::kLeaf, leaves_.size() - 1};
}

void WideTree::fill_corners(Leaf& leaf) const {
  // Two coordinates of a point share a vector register, in which the two operations that they need take one each.
  using Double2 = double __attribute__((vector_size(16)));
  struct Point {
    Double2 xy, z;
    [[nodiscard]] Float4 rounded() const {
      return Float4{static_cast<float>(xy[0]), static_cast<float>(xy[1]), static_cast<float>(z[0]), 0.0f};
    }
  };
  const Double2 origin_xy{origin_[0], origin_[1]}, origin_z{origin_[2], 0.0}, scale{scale_, scale_};
  Bounds4 bounds;
  std::array<std::array<Point, 3>, kWidth> at;
  for (std::size_t i = 0; i < leaf.count; ++i) {
    const auto& corners = soup_->faces[face(leaf, i)].corners;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3& v = soup_->vertices[corners[c]];
      at[i][c] = {(Double2{v[0], v[1]} - origin_xy) * scale, (Double2{v[2], 0.0} - origin_z) * scale};
      bounds.merge(at[i][c].rounded());
    }
  }
  leaf.center = axis_aligned_box(bounds).center;
  const auto center = [&](std::size_t k) { return static_cast<double>(leaf.center[k]); };
  const Double2 center_xy{center(0), center(1)}, center_z{center(2), 0.0};
  Float4 half{};
  for (std::size_t i = 0; i < kWidth; ++i) {
    // Lanes beyond the last repeat it; count says that they are none.
    const std::size_t from = std::min<std::size_t>(i, leaf.count - 1);
    for (std::size_t c = 0; c < 3; ++c) {
      const Float4 local = Point{at[from][c].xy - center_xy, at[from][c].z - center_z}.rounded();
      half = max4(half, max4(local, -local));
      for (std::size_t k = 0; k < 3; ++k) leaf.corners[c][k][i] = local[k];
    }
  }
  leaf.half = {half[0], half[1], half[2]};
}

OrientedBox WideTree::box(ChildSlot slot) const {
  if (slot != kRoot) return oriented_box(nodes_[slot / kWidth], slot % kWidth);
  OrientedBox whole;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto i = static_cast<int>(k);
    const double reach = std::max(soup_->box.hi[i] - origin_[i], origin_[i] - soup_->box.lo[i]);
    whole.half[k] = static_cast<float>(reach * scale_);
  }
  return whole;
}

WideTree::Node WideTree::lone(ChildSlot slot) const {
  Node node = childless_node();
  put_aligned(slot == kRoot ? box(kRoot) : aligned_box(nodes_[slot / kWidth], slot % kWidth), node, 0);
  put_oriented(box(slot), node, 0);
  return node;
}

// The bounds of a node or leaf whose own boxes are up to date.
Bounds4 WideTree::bounds(Ref ref) const {
  if (ref.kind() == Ref::kPending) return ranges_[ref.index()].bounds;
  if (ref.kind() == Ref::kLeaf) return bounds_of(leaves_[ref.index()].center, leaves_[ref.index()].half);
  const Node& node = nodes_[ref.index()];
  Bounds4 bounds;
  for (std::size_t i = 0; i < kWidth && node.children[i].kind() != Ref::kNone; ++i) {
    bounds.merge(bounds_of({node.center[0][i], node.center[1][i], node.center[2][i]},
                           {node.half[0][i], node.half[1][i], node.half[2][i]}));
  }
  return bounds;
}

// A box with the axes of before around what is in a child, or a new one around what is pending.
OrientedBox WideTree::refitted(Ref ref, const Bounds4& bounds, const OrientedBox& before) const {
  if (ref.kind() == Ref::kPending) return fitted(ranges_[ref.index()]);
  BoxFit fit(bounds);
  fit.turn_to(before.axes);
  if (ref.kind() == Ref::kNode) {
    const Node& node = nodes_[ref.index()];
    for (std::size_t i = 0; i < kWidth && node.children[i].kind() != Ref::kNone; ++i) fit.add(oriented_box(node, i));
    return fit.box();
  }
  const Leaf& leaf = leaves_[ref.index()];
  fit.add([&](auto&& use) {
    const auto point = [&](std::size_t corner, std::size_t i) {
      const auto& at = leaf.corners[corner];
      return Float4{at[0][i] + leaf.center[0], at[1][i] + leaf.center[1], at[2][i] + leaf.center[2], 0.0f};
    };
    for (std::size_t i = 0; i < leaf.count; ++i) use(point(0, i), point(1, i), point(2, i));
  });
  return fit.box();
}

void WideTree::refit() {
  assert(owner_ == nullptr);
  measure();
  if (!items_.empty()) make_points();
  for (SplitItem& item : items_) item = make_item(item.face());
  const auto measure_pending = [&](Ref ref) {
    if (ref.kind() != Ref::kPending) return;
    SplitRange& range = ranges_[ref.index()];
    range = measured(items_, range.begin, range.end);
  };
  measure_pending(root_);
  for (std::uint32_t i = 0; i < leaves_.size(); ++i) fill_corners(leaves_.at(i));
  for (std::uint32_t n = nodes_.size(); n-- > 0;) {  // children stand behind their parents
    Node& node = nodes_.at(n);
    for (std::size_t i = 0; i < kWidth && node.children[i].kind() != Ref::kNone; ++i) {
      measure_pending(node.children[i]);
      const Bounds4 around = bounds(node.children[i]);
      put_aligned(axis_aligned_box(around), node, i);
      put_oriented(refitted(node.children[i], around, oriented_box(node, i)), node, i);
    }
  }
}

// Trees of meshes are some ten nodes deep; collect_faces.cpp says how deep others are at most.
std::span<const std::uint32_t> WideTree::faces_below(ChildSlot slot) {
  const Ref ref = at(slot);
  if (ref.kind() == Ref::kLeaf) return faces(leaves_[ref.index()]);
  assert(ref.kind() == Ref::kNode);
  if (!below_[ref.index()].filled) {
    for (std::size_t i = 0; i < kWidth && nodes_[ref.index()].children[i].kind() != Ref::kNone; ++i) {
      (void)faces_below(child_slot(ref, i));
    }
    below_[ref.index()].filled = true;
  }
  return {faces_ + below_[ref.index()].first, below_[ref.index()].count};
}

void WideTree::build_all() {
  (void)at(kRoot);
  for (std::uint32_t n = 0; n < nodes_.size(); ++n) {
    for (std::size_t i = 0; i < kWidth && nodes_[n].children[i].kind() != Ref::kNone; ++i) {
      (void)at(child_slot(Ref(Ref::kNode, n), i));
    }
  }
  assert(std::ranges::all_of(nodes(), [](const Node& n) { return n.children[0].kind() <= Ref::kLeaf; }));
  for (FacesBelow& below : below_) below.filled = true;
  // An assignment of {} would keep the memory.
  items_ = std::vector<SplitItem>();
  points_ = std::vector<Float4>();
  ranges_ = std::vector<SplitRange>();
}

std::size_t WideTree::memory_bytes() const {
  return nodes_.memory_bytes() + leaves_.memory_bytes() + items_.capacity() * sizeof(SplitItem) +
         points_.capacity() * sizeof(Float4) + ranges_.capacity() * sizeof(SplitRange) +
         (own_faces_ == nullptr ? 0 : soup_->faces.size() * sizeof(std::uint32_t)) +
         below_.capacity() * sizeof(FacesBelow);
}

}  // namespace peerd::collision
