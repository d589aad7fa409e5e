#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "collision/exact/triangle.hpp"

// The triangle test over any arithmetic. `Signs` says what the signs of determinants are:
//   std::array<int, 3> sides(const Triangle& plane, const Triangle& of)   the sides of three corners, 1 where the plane
//                                                                         triangle runs counter-clockwise seen from
//                                                                         them
//   int volume(a, b, c, d)         of one point
//   int orient2d(a, b, c, i, j)      in the plane of the coordinates i and j
// With exact signs the answer is exact; the benchmarks put rounded ones beside it and count what they get wrong.
namespace peerd::collision::detail {

using Sides = std::array<int, 3>;
inline constexpr Sides kInPlane = {0, 0, 0};

struct Projection {
  int i, j;
};
inline constexpr Projection kProjections[] = {{1, 2}, {2, 0}, {0, 1}};

// A projection in which the triangle has an area; none where it has none in space. The first that is tried drops the
// coordinate that the triangle's normal, as rounded, has most of.
template <class Signs>
const Projection* area_projection(const Triangle& t, Signs& signs) {
  const Vec3 u = t[1] - t[0], v = t[2] - t[0];
  std::array<double, 3> size{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [i, j] = kProjections[k];
    size[k] = std::abs(u[i] * v[j] - u[j] * v[i]);
  }
  const auto first = static_cast<std::size_t>(std::ranges::max_element(size) - size.begin());
  for (std::size_t n = 0; n < 3; ++n) {
    const Projection& p = kProjections[(first + n) % 3];
    if (signs.orient2d(t[0], t[1], t[2], p.i, p.j) != 0) return &p;
  }
  return nullptr;
}

inline bool boxes_touch(const Triangle& a, const Triangle& b) {
  for (int k = 0; k < 3; ++k) {
    if (std::max({a[0][k], a[1][k], a[2][k]}) < std::min({b[0][k], b[1][k], b[2][k]}) ||
        std::max({b[0][k], b[1][k], b[2][k]}) < std::min({a[0][k], a[1][k], a[2][k]})) {
      return false;
    }
  }
  return true;
}

struct Segment {
  Vec3 p, q;  // may be equal
};

// Of collinear points: along a line, lexicographic order is one of its directions.
inline Segment hull_of_collinear(const Triangle& t) {
  const auto before = [](const Vec3& a, const Vec3& b) {
    return std::ranges::lexicographical_compare(std::array{a[0], a[1], a[2]}, std::array{b[0], b[1], b[2]});
  };
  const auto [least, most] = std::ranges::minmax(t, before);
  return {least, most};
}

// Closed segments of one plane, in a projection that maps the plane to one of the axes' planes, one to one.
template <class Signs>
bool segments_touch(const Segment& a, const Segment& b, const Projection& to, Signs& signs) {
  for (const int k : {to.i, to.j}) {
    if (std::max(a.p[k], a.q[k]) < std::min(b.p[k], b.q[k]) || std::max(b.p[k], b.q[k]) < std::min(a.p[k], a.q[k])) {
      return false;
    }
  }
  return signs.orient2d(a.p, a.q, b.p, to.i, to.j) * signs.orient2d(a.p, a.q, b.q, to.i, to.j) <= 0 &&
         signs.orient2d(b.p, b.q, a.p, to.i, to.j) * signs.orient2d(b.p, b.q, a.q, to.i, to.j) <= 0;
}

// Border or inside, of a triangle with an area.
template <class Signs>
bool contains(const Triangle& t, const Vec3& p, const Projection& to, Signs& signs) {
  int least = 1, most = -1;
  for (int e = 0; e < 3; ++e) {
    const int side = signs.orient2d(t[e], t[(e + 1) % 3], p, to.i, to.j);
    least = std::min(least, side);
    most = std::max(most, side);
  }
  return least >= 0 || most <= 0;
}

// An edge of `a`, which has an area, whose line has all of `b` strictly on its other side.
template <class Signs>
bool an_edge_separates(const Triangle& a, const Triangle& b, const Projection& to, Signs& signs) {
  const int inside = signs.orient2d(a[0], a[1], a[2], to.i, to.j);
  for (int e = 0; e < 3; ++e) {
    const auto outside = [&](const Vec3& p) { return signs.orient2d(a[e], a[(e + 1) % 3], p, to.i, to.j) == -inside; };
    if (outside(b[0]) && outside(b[1]) && outside(b[2])) return true;
  }
  return false;
}

// A projection in which three of the six points have an area, if there is one: then it maps their plane one to one.
template <class Signs>
const Projection* one_to_one(const Triangle& a, const Triangle& b, Signs& signs) {
  const std::array<Vec3, 6> points = {a[0], a[1], a[2], b[0], b[1], b[2]};
  for (std::size_t k = 2; k < 6; ++k) {
    for (std::size_t j = 1; j < k; ++j) {
      for (std::size_t i = 0; i < j; ++i) {
        if (const Projection* const p = area_projection({points[i], points[j], points[k]}, signs)) return p;
      }
    }
  }
  return nullptr;
}

// Both are of one plane, and one of them at least has no area.
template <class Signs>
bool touch_in_plane(const Triangle& a, const Triangle& b, bool a_has_area, bool b_has_area, Signs& signs) {
  const Projection* const to = one_to_one(a, b, signs);
  // All of one line: there, where boxes touch segments do.
  if (to == nullptr) return boxes_touch(a, b);
  for (std::size_t e = 0; e < 3; ++e) {
    for (std::size_t f = 0; f < 3; ++f) {
      if (segments_touch({a[e], a[(e + 1) % 3]}, {b[f], b[(f + 1) % 3]}, *to, signs)) return true;
    }
  }
  return (a_has_area && contains(a, b[0], *to, signs)) || (b_has_area && contains(b, a[0], *to, signs));
}

// A segment that has a point off the plane of a triangle with an area.
template <class Signs>
bool segment_crosses(const Segment& s, const Triangle& t, Signs& signs) {
  if (signs.volume(t[0], t[1], t[2], s.p) * signs.volume(t[0], t[1], t[2], s.q) > 0) return false;
  int least = 1, most = -1;
  for (int e = 0; e < 3; ++e) {
    const int side = signs.volume(s.p, s.q, t[e], t[(e + 1) % 3]);
    least = std::min(least, side);
    most = std::max(most, side);
  }
  return least >= 0 || most <= 0;
}

// Some triangle lies in the plane of the other or has no area, so that it has no plane of its own. `of_a`: of a's
// corners, seen from b's plane.
template <class Signs>
bool touch_flat(const Triangle& a, const Triangle& b, const Sides& of_a, Signs& signs) {
  if (!boxes_touch(a, b)) return false;
  const Projection* const of_plane_b = area_projection(b, signs);
  const Projection* const of_plane_a = area_projection(a, signs);
  if (of_plane_a != nullptr && of_plane_b != nullptr) {
    return !an_edge_separates(a, b, *of_plane_b, signs) && !an_edge_separates(b, a, *of_plane_b, signs);
  }
  if (of_plane_b != nullptr && of_a != kInPlane) return segment_crosses(hull_of_collinear(a), b, signs);
  if (of_plane_a != nullptr && signs.sides(a, b) != kInPlane) return segment_crosses(hull_of_collinear(b), a, signs);
  if (of_plane_a == nullptr && of_plane_b == nullptr) {
    const Segment s = hull_of_collinear(a), t = hull_of_collinear(b);
    if (signs.volume(s.p, s.q, t.p, t.q) != 0) return false;
  }
  return touch_in_plane(a, b, of_plane_a != nullptr, of_plane_b != nullptr, signs);
}

// The corner that both edges which reach the other plane start from; the other two are not strictly on its side.
inline int lone_corner(const Sides& sides) {
  for (int i = 0; i < 3; ++i) {
    const int next = sides[(i + 1) % 3], last = sides[(i + 2) % 3];
    if (sides[i] == 0 ? next == last && next != 0 : sides[i] != next && sides[i] != last) return i;
  }
  return 0;  // rounded signs only: exact ones that are neither all of one side nor all zero have such a corner
}

struct Corners {
  const Vec3 *lone, *next, *last;
  bool above;  // the lone corner is on the positive side, or the others are not
};
inline Corners corners_from_lone(const Triangle& t, const Sides& sides) {
  const int i = lone_corner(sides);
  return {&t[i], &t[(i + 1) % 3], &t[(i + 2) % 3], sides[i] > 0 || (sides[i] == 0 && sides[(i + 1) % 3] < 0)};
}

// After Guigue and Devillers, "Fast and Robust Triangle-Triangle Overlap Test Using Orientation Predicates", Journal of
// Graphics Tools 8 (2003): neither lies on one side of the other's plane, so both cut the line that the planes share,
// in an interval each. Turned so that each lone corner is above the other's plane, the intervals overlap where two
// determinants say so.
template <class Signs>
bool touch(const Triangle& a, const Triangle& b, Signs& signs) {
  const auto on_one_side = [](const Sides& s) { return s[0] != 0 && s[0] == s[1] && s[1] == s[2]; };
  const Sides of_a = signs.sides(b, a);
  if (on_one_side(of_a)) return false;
  if (of_a == kInPlane) return touch_flat(a, b, of_a, signs);
  const Sides of_b = signs.sides(a, b);
  if (on_one_side(of_b)) return false;
  if (of_b == kInPlane) return touch_flat(a, b, of_a, signs);
  Corners p = corners_from_lone(a, of_a), q = corners_from_lone(b, of_b);
  if (!p.above) std::swap(q.next, q.last);  // turns b's plane over
  if (!q.above) std::swap(p.next, p.last);
  return signs.volume(*p.lone, *p.next, *q.lone, *q.next) <= 0 && signs.volume(*p.lone, *p.last, *q.lone, *q.last) >= 0;
}

}  // namespace peerd::collision::detail
