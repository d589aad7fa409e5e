#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/plane_point.hpp"

namespace peerd {

// A CornerTree holds the corners of a polygon by their places, for questions about the inside of a triangle; corners
// disappear one by one. It is a k-d tree, halved at the median of its wider side (Bentley 1975), over places 0 .. n -
// 1, a corner each: a node is a range of places. For a few corners there is one node, and nothing is sorted.
class CornerTree {
 public:
  void build(std::span<const PlanePoint> points);  // the points stay in place
  void remove(std::uint32_t corner);

  [[nodiscard]] std::uint32_t corner_at(std::uint32_t place) const { return corners_[place]; }
  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(corners_.size()); }
  // Returns the first place from `from` on with a corner that is left and for which accepts(corner), or size().
  // `accepts` is called for all corners within the triangle a b c, which turns to the left, or on its boundary, and for
  // some others.
  template <class Accepts>
  [[nodiscard]] std::uint32_t find(std::uint32_t from, const PlanePoint& a, const PlanePoint& b, const PlanePoint& c,
                                   const Accepts& accepts) const {
    const Triangle triangle{{a, b, c}, box_of(std::span<const PlanePoint>({a, b, c}))};
    return find_in(0, 0, size(), from, triangle, accepts);
  }

 private:
  static constexpr std::uint32_t kLeaf = 32;  // corners at most
  struct Box {
    PlanePoint lo, hi;
    [[nodiscard]] bool meets(const Box& o) const {
      return lo.x <= o.hi.x && o.lo.x <= hi.x && lo.y <= o.hi.y && o.lo.y <= hi.y;
    }
    [[nodiscard]] bool holds(const PlanePoint& p) const {
      return lo.x <= p.x && p.x <= hi.x && lo.y <= p.y && p.y <= hi.y;
    }
  };
  struct Triangle {
    PlanePoint corners[3];
    Box box;
  };
  struct Node {  // the halves of node i are 2 i + 1 and 2 i + 2
    Box box;
    std::uint32_t left = 0;  // corners in it that are left
  };
  static Box box_of(std::span<const PlanePoint> points);
  static bool is_outside(const Box& box, const Triangle& triangle);
  void build_node(std::uint32_t node, std::uint32_t begin, std::uint32_t end);

  template <class Accepts>
  [[nodiscard]] std::uint32_t find_in(std::uint32_t node, std::uint32_t begin, std::uint32_t end, std::uint32_t from,
                                      const Triangle& triangle, const Accepts& accepts) const {
    if (end <= from || nodes_[node].left == 0 || !nodes_[node].box.meets(triangle.box)) return size();
    if (end - begin <= kLeaf) {
      for (std::uint32_t place = std::max(begin, from); place < end; ++place) {
        const std::uint32_t corner = corners_[place];
        if (!is_removed_[corner] && triangle.box.holds(points_[corner]) && accepts(corner)) return place;
      }
      return size();
    }
    if (is_outside(nodes_[node].box, triangle)) return size();
    const std::uint32_t middle = begin + (end - begin) / 2;
    const std::uint32_t place = find_in(2 * node + 1, begin, middle, from, triangle, accepts);
    return place < size() ? place : find_in(2 * node + 2, middle, end, from, triangle, accepts);
  }

  std::span<const PlanePoint> points_;
  // The arrays are kept from polygon to polygon for their memory.
  std::vector<std::uint32_t> corners_, places_;  // indexed by place, by corner
  std::vector<std::uint8_t> is_removed_;         // indexed by corner
  std::vector<Node> nodes_;
};

}  // namespace peerd
