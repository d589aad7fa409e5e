#include "core/geometry/corner_tree.hpp"

#include <bit>
#include <numeric>

namespace peerd {

CornerTree::Box CornerTree::box_of(std::span<const PlanePoint> points) {
  Box box{points[0], points[0]};
  for (const PlanePoint& p : points) {
    box.lo = {std::min(box.lo.x, p.x), std::min(box.lo.y, p.y)};
    box.hi = {std::max(box.hi.x, p.x), std::max(box.hi.y, p.y)};
  }
  return box;
}

// All of the box is beyond one edge, and this is no matter of rounding: for each edge the corner of the box that is
// farthest to its left is looked at.
bool CornerTree::is_outside(const Box& box, const Triangle& triangle) {
  for (int i = 0; i < 3; ++i) {
    const PlanePoint &p = triangle.corners[i], &q = triangle.corners[(i + 1) % 3];
    const PlanePoint leftmost{q.y > p.y ? box.lo.x : box.hi.x, q.x > p.x ? box.hi.y : box.lo.y};
    if (orient2d(p, q, leftmost) < 0) return true;
  }
  return false;
}

void CornerTree::build(std::span<const PlanePoint> points) {
  points_ = points;
  const auto count = static_cast<std::uint32_t>(points.size());
  corners_.resize(count);
  std::iota(corners_.begin(), corners_.end(), 0U);
  is_removed_.assign(count, 0);
  // Halves differ by one corner at most, so that all leaves are on the last two levels.
  const std::uint32_t leaves = std::bit_ceil((count + kLeaf - 1) / kLeaf);
  nodes_.resize(2 * std::size_t{leaves} - 1);
  build_node(0, 0, count);
  places_.resize(count);
  for (std::uint32_t place = 0; place < count; ++place) places_[corners_[place]] = place;
}

void CornerTree::build_node(std::uint32_t node, std::uint32_t begin, std::uint32_t end) {
  Box box{points_[corners_[begin]], points_[corners_[begin]]};
  for (std::uint32_t place = begin; place < end; ++place) {
    const PlanePoint& p = points_[corners_[place]];
    box.lo = {std::min(box.lo.x, p.x), std::min(box.lo.y, p.y)};
    box.hi = {std::max(box.hi.x, p.x), std::max(box.hi.y, p.y)};
  }
  nodes_[node] = {box, end - begin};
  if (end - begin <= kLeaf) return;
  const std::uint32_t middle = begin + (end - begin) / 2;
  // The widths are binary64, as in binary32 a width may be infinite. The way in which the tree is cut changes no
  // answer.
  const bool wide = static_cast<double>(box.hi.x) - static_cast<double>(box.lo.x) >
                    static_cast<double>(box.hi.y) - static_cast<double>(box.lo.y);
  const auto coordinate = [&](std::uint32_t corner) { return wide ? points_[corner].x : points_[corner].y; };
  std::ranges::nth_element(corners_.begin() + begin, corners_.begin() + middle, corners_.begin() + end, {}, coordinate);
  build_node(2 * node + 1, begin, middle);
  build_node(2 * node + 2, middle, end);
}

void CornerTree::remove(std::uint32_t corner) {
  is_removed_[corner] = 1;
  const std::uint32_t place = places_[corner];
  std::uint32_t node = 0, begin = 0, end = size();
  --nodes_[0].left;
  while (end - begin > kLeaf) {
    const std::uint32_t middle = begin + (end - begin) / 2;
    node = 2 * node + (place < middle ? 1 : 2);
    (place < middle ? end : begin) = middle;
    --nodes_[node].left;
  }
}

}  // namespace peerd
