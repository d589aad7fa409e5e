#pragma once
#include <algorithm>
#include <cassert>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "collision/exact/triangle_soup.hpp"

namespace peerd::collision::engines {

// Room for rounding, as a part of the largest coordinate: the few dozen operations of binary64 that make a volume, or
// compare two, are each off by 2^-53 of numbers of that size at most.
inline constexpr double kRounding = 0x1p-40;

// A binary hierarchy over the triangles of a soup, one of them in each leaf, built from the top at once. It is split as
// RAPID splits (Gottschalk, Lin and Manocha 1996, section 4): across the volume's longest axis at the mean of the
// triangles' centroids, or else the next longest; where no axis parts them, in the middle of their order.
//
// A Volume has
//   static Volume around(soup, faces)   which contains these triangles
//   axes()                              three directions, the longest first
template <class Volume>
class VolumeTree {
 public:
  struct Node {
    Volume volume;
    std::uint32_t begin = 0, end = 0;  // the node's range of the faces
    std::uint32_t left = 0;            // its children are nodes left and left + 1; 0: it is a leaf
  };

  explicit VolumeTree(const TriangleSoup& soup) : soup_(&soup), faces_(soup.faces.size()) {
    assert(!faces_.empty());
    std::iota(faces_.begin(), faces_.end(), 0u);
    nodes_.reserve(2 * faces_.size() - 1);
    add_node(0, static_cast<std::uint32_t>(faces_.size()));
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) split(i);
  }

  [[nodiscard]] const TriangleSoup& soup() const { return *soup_; }
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }
  // The triangle of a leaf.
  [[nodiscard]] std::uint32_t face(const Node& leaf) const { return faces_[leaf.begin]; }
  [[nodiscard]] std::span<const std::uint32_t> faces(const Node& node) const {
    return std::span(faces_).subspan(node.begin, node.end - node.begin);
  }

 private:
  void add_node(std::uint32_t begin, std::uint32_t end) {
    const std::span<const std::uint32_t> faces = std::span(faces_).subspan(begin, end - begin);
    nodes_.push_back({Volume::around(*soup_, faces), begin, end, 0});
  }

  void split(std::uint32_t i) {
    const auto [begin, end] = std::pair(nodes_[i].begin, nodes_[i].end);
    if (end - begin == 1) return;
    std::uint32_t middle = begin + (end - begin) / 2;
    for (const Vec3& axis : nodes_[i].volume.axes()) {
      const std::uint32_t at = partition(begin, end, axis);
      if (at == begin || at == end) continue;
      middle = at;
      break;
    }
    nodes_[i].left = static_cast<std::uint32_t>(nodes_.size());
    add_node(begin, middle);
    add_node(middle, end);
  }

  // Three times the place of a triangle's centroid along an axis.
  [[nodiscard]] double place(std::uint32_t face, const Vec3& axis) const {
    const Triangle t = soup_->triangle(face);
    return t[0].dot(axis) + t[1].dot(axis) + t[2].dot(axis);
  }
  // Returns where those beyond the mean begin.
  std::uint32_t partition(std::uint32_t begin, std::uint32_t end, const Vec3& axis) {
    double mean = 0.0;
    for (std::uint32_t i = begin; i < end; ++i) mean += place(faces_[i], axis) / (end - begin);
    const auto from = faces_.begin() + begin;
    const auto at =
        std::stable_partition(from, faces_.begin() + end, [&](std::uint32_t face) { return place(face, axis) < mean; });
    return begin + static_cast<std::uint32_t>(at - from);
  }

  const TriangleSoup* soup_;
  std::vector<std::uint32_t> faces_;
  std::vector<Node> nodes_;
};

}  // namespace peerd::collision::engines
