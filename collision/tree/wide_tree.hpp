#pragma once
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "collision/exact/triangle_soup.hpp"
#include "collision/tree/binned_split.hpp"
#include "collision/tree/chunks.hpp"
#include "collision/tree/oriented_box.hpp"

namespace peerd::collision {

// A hierarchy of boxes that a vector unit tests eight at a time, over the triangles of a soup; queries run on it.
// Leaves hold eight triangles at most, nodes eight children, each with an axis-aligned box and an oriented one. Nodes
// are split where the surface-area heuristic is least, the child with the largest surface first, from the top as deep
// as queries reach. KdopTree (kdop_tree.hpp) is its readable twin; both give the same answers.
//
// Everything in it is binary32, relative to `origin` and times `scale`, rounded to nearest: a coordinate may be off by
// 2^-23 of `extent_m`, which queries must allow for. Nothing in it decides an answer. It is the same on every machine.
class WideTree {
 public:
  static constexpr std::size_t kWidth = 8;

  // A child, by kind and index. Pending ones are built when a query comes to them.
  class Ref {
   public:
    enum Kind : std::uint32_t { kNode, kLeaf, kPending, kNone };
    constexpr Ref() = default;
    constexpr Ref(Kind kind, std::uint32_t index) : bits_(static_cast<std::uint32_t>(kind) << 30 | index) {}
    [[nodiscard]] constexpr Kind kind() const { return static_cast<Kind>(bits_ >> 30); }
    [[nodiscard]] constexpr std::uint32_t index() const { return bits_ & 0x3fff'ffff; }

   private:
    std::uint32_t bits_ = 0xffff'ffff;  // kind kNone
  };

  // Half the side of a box that isn't there: it overlaps nothing, however it is turned and scaled, since what becomes
  // no number on the way overlaps nothing either.
  static constexpr float kNoBox = -std::numeric_limits<float>::infinity();

  // Children that are there stand before those that aren't.
  struct alignas(64) Node {
    using Rows = std::array<std::array<float, kWidth>, 3>;  // by axis, then child [m]
    Rows center, half;
    std::array<Ref, kWidth> children;
    Rows oriented_center, oriented_half;  // the oriented boxes
    std::array<Rows, 3> axes;             // theirs: by axis, then component, then child
  };
  // Five lines of the processor's cache. Its faces stand in the tree's list of them.
  struct alignas(64) Leaf {
    std::array<float, 3> center, half;  // the box of the whole leaf [m]
    std::uint32_t first_face = 0;       // of the list
    std::uint32_t count = 0;
    std::array<std::array<std::array<float, kWidth>, 3>, 3> corners;  // from `center`; by corner, axis, triangle [m]
  };

  // The soup has a face, and fewer than 2^30; it outlives the tree, at its place.
  explicit WideTree(const TriangleSoup& soup);
  // A complete tree of the same soup that was built before: the root is the first node, or the only leaf; leaves stand
  // in the list of faces in the tree's order. The memory of the spans stays as long as `owner` does. hierarchy_file.hpp
  // checks such trees.
  WideTree(const TriangleSoup& soup, std::shared_ptr<const void> owner, std::span<const Node> nodes,
           std::span<const Leaf> leaves, std::span<const std::uint32_t> faces);
  WideTree(WideTree&&) = default;
  WideTree& operator=(WideTree&&) = default;

  [[nodiscard]] const TriangleSoup& soup() const { return *soup_; }
  [[nodiscard]] const Vec3& origin() const { return origin_; }  // in the soup's frame
  // A power of two: 1, but for soups so large that binary32 would overflow.
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] double extent_m() const { return extent_m_; }  // no coordinate is farther from the origin
  [[nodiscard]] const Node& node(std::uint32_t i) const { return nodes_[i]; }
  [[nodiscard]] const Leaf& leaf(std::uint32_t i) const { return leaves_[i]; }
  // The soup's face that a leaf's triangle is.
  [[nodiscard]] std::uint32_t face(const Leaf& leaf, std::size_t i) const {
    assert(i < leaf.count);
    return faces_[leaf.first_face + i];
  }
  [[nodiscard]] std::span<const std::uint32_t> faces(const Leaf& leaf) const {
    return {faces_ + leaf.first_face, leaf.count};
  }

  // The slot of a child in its parent: a child that is not built yet has no other name.
  using ChildSlot = std::uint32_t;
  static constexpr ChildSlot kRoot = ~0u;
  [[nodiscard]] static constexpr ChildSlot child_slot(Ref node, std::size_t i) {
    assert(node.kind() == Ref::kNode && i < kWidth);
    return node.index() * kWidth + static_cast<ChildSlot>(i);
  }
  [[nodiscard]] static constexpr Ref parent(ChildSlot slot) {
    return {Ref::kNode, static_cast<std::uint32_t>(slot / kWidth)};
  }  // not of the root
  // The node or leaf in a slot, built now if it never was. References to both stay valid.
  [[nodiscard]] Ref at(ChildSlot slot) {
    const Ref ref = peek(slot);
    return ref.kind() != Ref::kPending ? ref : resolve(slot);
  }
  // The same, which may be pending.
  [[nodiscard]] Ref peek(ChildSlot slot) const {
    return slot == kRoot ? root_ : nodes_[slot / kWidth].children[slot % kWidth];
  }
  // The oriented box of what is in a slot.
  [[nodiscard]] OrientedBox box(ChildSlot slot) const;
  // A node whose only child has the boxes of what is in a slot, for kernels that take nodes.
  [[nodiscard]] Node lone(ChildSlot slot) const;
  void build_all();
  // The faces of all leaves below a slot, in the tree's order: they stand in a row. Builds what is below, once.
  [[nodiscard]] std::span<const std::uint32_t> faces_below(ChildSlot slot);
  // The soup's vertices have moved, its faces have not: new boxes for what is built, over the same triangles. O(soup).
  void refit();
  [[nodiscard]] bool refittable() const { return owner_ == nullptr; }  // false for a tree that was read from a file

  // The nodes and leaves built here: none for a tree that was read from a file.
  [[nodiscard]] std::size_t nodes_built() const {
    return owner_ == nullptr ? std::size_t{nodes_.size()} + leaves_.size() : 0;
  }
  // The nodes and leaves that are there.
  [[nodiscard]] auto nodes() const { return nodes_.all(); }
  [[nodiscard]] auto leaves() const { return leaves_.all(); }
  // The faces of all leaves, in the tree's order, of a tree that is built to its end.
  [[nodiscard]] std::span<const std::uint32_t> faces() const { return {faces_, soup_->faces.size()}; }
  [[nodiscard]] std::size_t memory_bytes() const;  // what was allocated here

 private:
  // The faces below a node: a range of the list, which is filled once all that is below is built.
  struct FacesBelow {
    std::uint32_t first, count;
    bool filled;
  };

  Ref resolve(ChildSlot slot);
  Ref pending(const SplitRange& range);
  Ref make_node(const SplitRange& range);
  Ref make_leaf(const SplitRange& range);
  void make_points();
  [[nodiscard]] SplitItem make_item(std::uint32_t face) const;
  void fill_corners(Leaf& leaf) const;
  [[nodiscard]] OrientedBox fitted(const SplitRange& range) const;
  [[nodiscard]] OrientedBox refitted(Ref ref, const Bounds4& bounds, const OrientedBox& before) const;
  [[nodiscard]] Bounds4 bounds(Ref ref) const;
  void measure();

  const TriangleSoup* soup_;
  std::shared_ptr<const void> owner_;  // keeps the memory of the arrays, where that is not the tree's own
  Vec3 origin_;
  double extent_m_ = 0.0;
  double scale_ = 1.0;
  Ref root_;
  Chunks<Node> nodes_;
  Chunks<Leaf> leaves_;
  const std::uint32_t* faces_ = nullptr;        // the list, one for each face of the soup
  std::unique_ptr<std::uint32_t[]> own_faces_;  // the same memory, where it isn't the owner's
  std::vector<FacesBelow> below_;               // by node
  std::vector<SplitItem> items_;                // gone when all is built
  std::vector<Float4> points_;                  // the soup's vertices in the tree's numbers; gone when all is built
  std::vector<SplitRange> ranges_;              // the ranges of pending children, by index
};

// A node without children, and the boxes of one of them.
[[nodiscard]] WideTree::Node childless_node();
void put_aligned(const OrientedBox& box, WideTree::Node& node, std::size_t child);
void put_oriented(const OrientedBox& box, WideTree::Node& node, std::size_t child);

}  // namespace peerd::collision
