#pragma once
#include <algorithm>
#include <cassert>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "collision/engines/realign_by.hpp"
#include "collision/engines/volume_tree.hpp"
#include "collision/exact/relative_motion.hpp"
#include "collision/tree/kdop_tree.hpp"
#include "collision/tree/kdop_volume.hpp"

namespace peerd::collision::engines {

// Points of a soup's triangles whose convex hull contains all of those [m]: the corners of the hull, or all points
// where they lie in one plane.
[[nodiscard]] std::vector<Vec3> hull_of(const TriangleSoup& soup);

// The vertices of the boundary of a node of a tree [m]. The slabs are wider than the node's by a room that covers the
// rounding of the cuts, so that the convex hull of the vertices contains the node. Vertices that are nearer to each
// other than a sixteenth of that room are one.
template <int K>
[[nodiscard]] std::vector<Vec3> boundary_vertices(const Kdop<K>& dop, double extent_m) {
  const double room_m = 16.0 * kRounding * extent_m + 0x1p-200;
  WideKdop<K> wide;
  for (std::size_t i = 0; i < wide.kSlabs; ++i) {
    // Slabs of the largest coordinates are infinite; no sum of three coordinates is.
    wide.lo[i] = std::max(static_cast<double>(dop.lo[i]), -3.0 * extent_m) - room_m;
    wide.hi[i] = std::min(static_cast<double>(dop.hi[i]), 3.0 * extent_m) + room_m;
  }
  std::vector<Vec3> vertices;
  for (const std::vector<Vec3>& face : boundary(wide)) {
    for (const Vec3& corner : face) {
      const auto same = [&](const Vec3& other) { return (corner - other).cwiseAbs().maxCoeff() < room_m / 16.0; };
      if (std::ranges::none_of(vertices, same)) vertices.push_back(corner);
    }
  }
  assert(!vertices.empty());
  return vertices;
}

// The k-DOP, in the frame of A, of vertices whose coordinates are within `extent_m`: it contains what is in their
// convex hull as a_from_b rounds it.
template <int K>
[[nodiscard]] WideKdop<K> dop_of_moved(std::span<const Vec3> vertices, const RelativeMotion& a_from_b,
                                       double extent_m) {
  auto out = WideKdop<K>::empty();
  for (const Vec3& vertex : vertices) {
    const Vec3 moved = a_from_b(vertex);
    for (std::size_t i = 0; i < out.kSlabs; ++i) {
      const double at = along(out.kDirections[i], moved);
      out.lo[i] = std::min(out.lo[i], at);
      out.hi[i] = std::max(out.hi[i], at);
    }
  }
  const double pad_m = 4.0 * kRounding * (3.0 * extent_m + a_from_b.translation.cwiseAbs().sum()) + 0x1p-200;
  for (std::size_t i = 0; i < out.kSlabs; ++i) {
    out.lo[i] -= pad_m;
    out.hi[i] += pad_m;
  }
  return out;
}

// The vertices by which the nodes of one tree are realigned; those of a node are computed when it is first asked for
// (the thesis's preprocessing step, where it is needed).
template <int K>
class NodeVertices {
 public:
  NodeVertices(const KdopTree<K>& tree, RealignBy by)
      : tree_(&tree), by_(by), extent_m_(largest_coordinate(tree.soup().box)) {}

  // The numbers of nodes are those of the tree, which never change.
  [[nodiscard]] const std::vector<Vec3>& of(std::uint32_t node) {
    std::vector<Vec3>& vertices = of_node_[node];
    if (!vertices.empty()) return vertices;
    const bool by_hull = by_ == RealignBy::kHull && node == KdopTree<K>::kRoot;
    vertices = by_hull ? hull_of(tree_->soup()) : boundary_vertices<K>(tree_->node(node).dop, extent_m_);
    return vertices;
  }
  [[nodiscard]] WideKdop<K> realigned(std::uint32_t node, const RelativeMotion& a_from_b) {
    return dop_of_moved<K>(of(node), a_from_b, 2.0 * extent_m_);
  }

 private:
  const KdopTree<K>* tree_;
  RealignBy by_;
  double extent_m_;
  std::map<std::uint32_t, std::vector<Vec3>> of_node_;
};

}  // namespace peerd::collision::engines
