#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "tests/collision/query/wide_kernels.hpp"

namespace peerd::collision::test {

// Oriented boxes for tests of the kernels that take nodes, and what is true of them in binary64.

// A box, or what points that move each at their own velocity make of one: `center` and what sides of a half length
// `half` along `sides` reach. Sides without a length keep their direction.
struct Parallelepiped {
  Vec3 center, half;
  std::array<Vec3, 3> sides;

  [[nodiscard]] double reach(const Vec3& n) const {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) sum += half[k] * std::abs(n.dot(sides[static_cast<std::size_t>(k)]));
    return sum;
  }
};
inline Parallelepiped exactly(const OrientedBox& box) {
  Parallelepiped out;
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    out.center[k] = static_cast<double>(box.center[i]);
    out.half[k] = static_cast<double>(box.half[i]);
    for (int c = 0; c < 3; ++c) out.sides[i][c] = static_cast<double>(box.axes[i][static_cast<std::size_t>(c)]);
  }
  return out;
}
inline Parallelepiped operator*(const RelativeMotion& motion, const Parallelepiped& p) {
  return {motion(p.center),
          p.half,
          {motion.rotation * p.sides[0], motion.rotation * p.sides[1], motion.rotation * p.sides[2]}};
}

// The gap between two along an axis: negative where they overlap along it.
inline double gap_along(const Parallelepiped& a, const Parallelepiped& b, const Vec3& n) {
  return std::abs(n.dot(b.center - a.center)) - (a.reach(n) + b.reach(n));
}
// The largest gap along the normals of faces and the products of sides: 0 or less where the two share a point.
inline double separation(const Parallelepiped& a, const Parallelepiped& b) {
  double most = -std::numeric_limits<double>::infinity();
  const auto try_axis = [&](const Vec3& u, const Vec3& v) {
    const Vec3 n = u.cross(v);
    if (n.norm() > 1e-9 * u.norm() * v.norm()) most = std::max(most, gap_along(a, b, n.normalized()));
  };
  for (std::size_t i = 0; i < 3; ++i) {
    try_axis(a.sides[i], a.sides[(i + 1) % 3]);
    try_axis(b.sides[i], b.sides[(i + 1) % 3]);
    for (const Vec3& side : b.sides) try_axis(a.sides[i], side);
  }
  return most;
}

// A box within 4 m of the origin: thick, flat, a needle, flat without a thickness, a point, or axis-aligned.
inline OrientedBox random_box(Numbers& numbers, int kind) {
  const Mat3 turn = kind % 6 == 5 ? Mat3::Identity() : random_pose(numbers, 1.0).orientation.toRotationMatrix();
  const double size = std::exp2(numbers.between(-4.0, 0.5));
  Vec3 half = size * Vec3(1.0, numbers.between(0.2, 1.0), numbers.between(0.2, 1.0));
  if (kind % 6 == 1) half[2] *= 1e-4;
  if (kind % 6 == 2) half[1] *= 1e-3, half[2] *= 1e-3;
  if (kind % 6 == 3) half[2] = 0.0;
  if (kind % 6 == 4) half = Vec3::Zero();
  const Vec3 center = numbers.point(2.0);
  OrientedBox box;
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    box.center[i] = static_cast<float>(center[k]);
    box.half[i] = static_cast<float>(half[k]);
    for (int c = 0; c < 3; ++c) box.axes[i][static_cast<std::size_t>(c)] = static_cast<float>(turn(c, k));
  }
  return box;
}

// The axis-aligned box around one, with room for its rounding.
inline OrientedBox aligned_around(const OrientedBox& box) {
  const Parallelepiped exact = exactly(box);
  OrientedBox out;
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    out.center[i] = box.center[i];
    out.half[i] = static_cast<float>(exact.reach(Vec3::Unit(k)) * (1.0 + 0x1p-20));
  }
  return out;
}

// Two nodes of eight random boxes each, and trees of the extent that WideMotion is to have.
struct BoxPair {
  std::array<OrientedBox, WideTree::kWidth> boxes_a, boxes_b;
  WideTree::Node a = childless_node(), b = childless_node();
  TriangleSoup soup;
  WideTree tree;
  RelativeMotion a_from_b;
  WideMotion motion;

  BoxPair(Numbers& numbers, const RelativeMotion& moves, int kinds)
      : soup(around_all_boxes()), tree(soup), a_from_b(moves), motion(tree, tree, moves) {
    for (std::size_t i = 0; i < WideTree::kWidth; ++i) {
      put(boxes_a[i] = random_box(numbers, kinds + static_cast<int>(i)), a, i);
      put(boxes_b[i] = random_box(numbers, kinds / 6 + static_cast<int>(i)), b, i);
    }
  }
  BoxPair(const BoxPair&) = delete;
  BoxPair& operator=(const BoxPair&) = delete;

 private:
  static TriangleSoup around_all_boxes() {
    TriangleSoup soup;
    soup.vertices = {Vec3(-8, -8, -8), Vec3(8, 8, 8), Vec3(8, -8, 8)};
    soup.faces.push_back({{0, 1, 2}, 0});
    for (const Vec3& v : soup.vertices) soup.box.merge(v);
    return soup;
  }
  static void put(const OrientedBox& box, WideTree::Node& node, std::size_t i) {
    put_aligned(aligned_around(box), node, i);
    put_oriented(box, node, i);
  }
};

// A square of two times `squares`^2 triangles and a side of 2 m, which stands aslant to all axes.
inline TriangleSoup aslant_plate(std::uint32_t squares) {
  const Quat turn = Quat(0.8, 0.3, -0.4, 0.2).normalized();
  TriangleSoup soup;
  for (std::uint32_t i = 0; i <= squares; ++i) {
    for (std::uint32_t j = 0; j <= squares; ++j) {
      soup.vertices.push_back(turn * Vec3(2.0 * i / squares - 1.0, 2.0 * j / squares - 1.0, 0.0));
      soup.box.merge(soup.vertices.back());
    }
  }
  for (std::uint32_t i = 0; i < squares; ++i) {
    for (std::uint32_t j = 0; j < squares; ++j) {
      const std::uint32_t corner = i * (squares + 1) + j, next = corner + squares + 1, polygon = i * squares + j;
      soup.faces.push_back({{corner, next, next + 1}, polygon});
      soup.faces.push_back({{corner, next + 1, corner + 1}, polygon});
    }
  }
  return soup;
}
// The unit normal of that plate.
inline Vec3 plate_normal() { return Quat(0.8, 0.3, -0.4, 0.2).normalized() * Vec3(0, 0, 1); }

}  // namespace peerd::collision::test
