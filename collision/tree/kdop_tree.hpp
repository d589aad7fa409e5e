#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "collision/exact/triangle_soup.hpp"
#include "collision/tree/kdop.hpp"
#include "collision/tree/split_rule.hpp"

namespace peerd::collision {

struct TreeOptions {
  SplitRule rule = SplitRule::kSplatter;
  std::uint32_t split_threshold = 4;  // a node of more triangles is split; at least 1

  friend bool operator==(const TreeOptions&, const TreeOptions&) = default;
};

// A binary hierarchy of k-DOPs over the triangles of a soup, in the soup's frame: that of the thesis (3.2). It is built
// from the top as deep as queries go, so that a query pays for the nodes that it visits; one tree serves all instances
// of a mesh. Answers don't depend on how much of it has been built.
//
// Not thread-safe, since queries build. The soup outlives the tree, at its place.
template <int K>
class KdopTree {
 public:
  struct Node {
    Kdop<K> dop;               // contains the node's triangles as real numbers have them
    std::uint32_t begin, end;  // the node's range of order()
    std::uint32_t left;        // its children are nodes[left] and nodes[left + 1]; or one of the two below
  };
  static constexpr std::uint32_t kLeaf = ~0u, kUnsplit = ~0u - 1;

  KdopTree(const TriangleSoup& soup, const TreeOptions& options);  // the root only; the soup has a face

  [[nodiscard]] const TriangleSoup& soup() const { return *soup_; }
  [[nodiscard]] const TreeOptions& options() const { return options_; }
  static constexpr std::uint32_t kRoot = 0;
  // Valid until the next split.
  [[nodiscard]] const Node& node(std::uint32_t i) const { return nodes_[i]; }
  // The index of a node's left child, or kLeaf; the node is split now if it never was.
  std::uint32_t children(std::uint32_t i) {
    if (nodes_[i].left == kUnsplit) split(i);
    return nodes_[i].left;
  }
  // The indices of a node's triangles in the soup.
  [[nodiscard]] std::span<const std::uint32_t> triangles(const Node& node) const {
    return std::span(order_).subspan(node.begin, node.end - node.begin);
  }
  void build_all();
  // Computes new slabs for vertices that have moved, without a change of topology: `soup` has the faces of the one
  // before and replaces it. The cost is that of the nodes that are built. Without a refit, a tree of moved vertices
  // would miss contacts.
  void refit(const TriangleSoup& soup);

  [[nodiscard]] std::span<const Node> nodes() const { return nodes_; }
  [[nodiscard]] std::span<const std::uint32_t> order() const { return order_; }
  [[nodiscard]] std::uint32_t height() const;  // levels below the root, of what is built
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  using Centroid = std::array<float, 3>;
  void project_vertices();
  [[nodiscard]] Kdop<K> bound(std::uint32_t begin, std::uint32_t end) const;
  void split(std::uint32_t i);
  std::uint32_t partition(const Node& node, std::uint32_t depth);
  std::uint32_t partition_at(const Node& node, int axis, float at);
  [[nodiscard]] Centroid mean(const Node& node) const;
  [[nodiscard]] int longest_side(const Node& node) const;
  [[nodiscard]] int largest_variance(const Node& node, const Centroid& mean) const;
  [[nodiscard]] int least_volume(const Node& node, SplitRule rule, const Centroid& mean);
  std::uint32_t partition_by_area(const Node& node);

  const TriangleSoup* soup_;
  TreeOptions options_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> depth_;  // by node: its depth, which only the combined rules need
  std::vector<std::uint32_t> order_;
  // The projections of a vertex, rounded to nearest; padded with zeros, so that four make a vector register.
  using Projections = std::array<float, (K / 2 + 3) / 4 * 4>;
  std::vector<Projections> projections_;
  std::vector<Centroid> centroids_;  // by face: its centroid times three quarters, which never overflows
};

extern template class KdopTree<6>;
extern template class KdopTree<14>;
extern template class KdopTree<18>;
extern template class KdopTree<26>;

}  // namespace peerd::collision
