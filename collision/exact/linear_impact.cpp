#include "collision/exact/linear_impact.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "collision/exact/orientation.hpp"

namespace peerd::collision {
namespace {

using detail::Interval;
using detail::ParameterBox;

// The first in time first, then the smallest: all of an area may meet at one time, and one point of it will do.
struct Later {
  bool operator()(const ParameterBox& a, const ParameterBox& b) const {
    const double ta = a.side[0].lo, tb = b.side[0].lo;
    if (ta != tb) return ta > tb;
    const auto size = [](const ParameterBox& c) {
      return std::max({c.side[0].width(), c.side[1].width(), c.side[2].width()});
    };
    return size(a) > size(b);
  }
};

Vec3 at(const MovingPoint& p, double t) { return p.at_0 * (1.0 - t) + p.at_1 * t; }

// The function whose zero is sought: a vector that is linear in each of (t, u, v).
struct VertexFace {
  const MovingPoint& vertex;
  const std::array<MovingPoint, 3>& face;

  [[nodiscard]] Vec3 operator()(double t, double u, double v) const {
    const Vec3 a = at(face[0], t), b = at(face[1], t), c = at(face[2], t);
    return at(vertex, t) - ((a + (b - a) * u) + (c - a) * v);
  }
  // Beyond the third edge. u and v are multiples of a power of two, and so is their sum: 53 bits hold it.
  [[nodiscard]] bool outside(const ParameterBox& cell) const { return cell.side[1].lo + cell.side[2].lo > 1.0; }
  [[nodiscard]] bool inside(double u, double v) const { return u + v <= 1.0; }
};

struct EdgeEdge {
  const std::array<MovingPoint, 2>& a;
  const std::array<MovingPoint, 2>& b;

  [[nodiscard]] Vec3 operator()(double t, double u, double v) const {
    const Vec3 p = at(a[0], t), q = at(b[0], t);
    return (p + (at(a[1], t) - p) * u) - (q + (at(b[1], t) - q) * v);
  }
  [[nodiscard]] bool outside(const ParameterBox&) const { return false; }
  [[nodiscard]] bool inside(double, double) const { return true; }
};

double largest(const Vec3& v) { return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}); }

// The image of a box by its eight corners; bit i of a corner's number says whether it is at the end of side i.
using Image = std::array<Vec3, 8>;

template <class Distance>
Image image_of(const Distance& distance, const ParameterBox& cell) {
  Image image;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const auto end = [&](std::size_t side) {
      return (corner >> side & 1) != 0 ? cell.side[side].hi : cell.side[side].lo;
    };
    image[corner] = distance(end(0), end(1), end(2));
  }
  return image;
}

// The part of a cell's time, as fractions of it, in which its image may be as near to 0 as `near` along each axis. At
// each instant the image is within the values at four corners, and those are linear in time.
Interval near_part(const Image& image, double near) {
  Interval part;
  for (int k = 0; k < 3; ++k) {
    for (const double sign : {1.0, -1.0}) {
      Interval apart{1.0, 0.0};  // until when all four are beyond, and from when
      for (std::size_t corner = 0; corner < 8; corner += 2) {
        const double g0 = sign * image[corner][k] - near, g1 = sign * image[corner + 1][k] - near;
        if (g0 <= 0.0) apart.lo = 0.0;
        if (g1 <= 0.0) apart.hi = 1.0;
        if (g0 > 0.0 && g1 <= 0.0) apart.lo = std::min(apart.lo, g0 / (g0 - g1));
        if (g0 <= 0.0 && g1 > 0.0) apart.hi = std::max(apart.hi, g0 / (g0 - g1));
      }
      part.lo = std::max(part.lo, apart.lo);
      part.hi = std::min(part.hi, apart.hi);
    }
  }
  return part;
}

// Whether a corner of the cell at its first time is a place on both primitives where they are near.
template <class Distance>
bool meet_at_begin(const Distance& distance, const ParameterBox& cell, const Image& image, double near_enough) {
  for (std::size_t corner = 0; corner < 8; corner += 2) {
    const double u = (corner & 2) != 0 ? cell.side[1].hi : cell.side[1].lo;
    const double v = (corner & 4) != 0 ? cell.side[2].hi : cell.side[2].lo;
    if (distance.inside(u, v) && largest(image[corner]) <= near_enough) return true;
  }
  return false;
}

// Less of a cell than this, of its time, is not worth being cut off by itself.
constexpr double kWorthCutting = 0x1p-4;
// A time is rounded by less than this.
constexpr double kTimeRounding = 0x1p-50;

template <class Distance>
LinearImpact first_root(const Distance& distance, double largest_coordinate, const ImpactOptions& options,
                        std::vector<ParameterBox>& open) {
  // Some 20 roundings of numbers of at most three times the largest coordinate; of a corner that the caller has rounded
  // to binary64 once, that is one more.
  assert(std::isfinite(largest_coordinate) && options.tolerance_m >= 0.0 && options.margin_m >= 0.0);
  assert(options.begin >= 0.0 && options.begin <= 1.0);
  const double rounding = 128.0 * kUnitRoundoff * largest_coordinate;
  const double near = (options.margin_m + rounding) * (1.0 + 4.0 * kUnitRoundoff);
  const double near_enough = near + std::max(options.tolerance_m - 2.0 * rounding, 2.0 * rounding);
  // The extents of the image along each side of the box: the side to halve is the one with the widest image.
  std::array<double, 3> reach = {0.0, 0.0, 0.0};
  const Image whole = image_of(distance, ParameterBox{});
  for (std::size_t corner = 0; corner < 8; ++corner) {
    for (std::size_t side = 0; side < 3; ++side) {
      if ((corner >> side & 1) != 0) continue;
      reach[side] = std::max(reach[side], largest(whole[corner | std::size_t{1} << side] - whole[corner]));
    }
  }
  open.assign(1, ParameterBox{});
  open.front().side[0].lo = options.begin;
  LinearImpact impact;
  const auto push = [&open](const ParameterBox& cell) {
    open.push_back(cell);
    std::ranges::push_heap(open, Later());
  };
  while (!open.empty()) {
    std::ranges::pop_heap(open, Later());
    ParameterBox cell = open.back();
    open.pop_back();
    Interval& time = cell.side[0];
    if (time.lo > options.last) break;  // and so are all others
    if (impact.iterations == options.max_iterations) return {ImpactState::kUnsure, time.lo, impact.iterations};
    ++impact.iterations;
    assert(time.lo >= 0.0 && time.hi <= 1.0 && time.lo <= time.hi);
    if (distance.outside(cell)) continue;
    const Image image = image_of(distance, cell);
    const Interval part = near_part(image, near);
    if (part.lo > part.hi + kTimeRounding) continue;
    const Interval cut{std::max(time.lo, time.lo + time.width() * part.lo - kTimeRounding),
                       std::min(time.hi, time.lo + time.width() * part.hi + kTimeRounding)};
    if (cut.width() < (1.0 - kWorthCutting) * time.width()) {
      time = cut;
      push(cell);
      continue;
    }
    std::size_t widest = 0;
    for (std::size_t side = 1; side < 3; ++side) {
      if (reach[side] * cell.side[side].width() > reach[widest] * cell.side[widest].width()) widest = side;
    }
    const Interval& side = cell.side[widest];
    const double middle = side.lo + side.width() / 2.0;
    if (meet_at_begin(distance, cell, image, near_enough) || middle == side.lo || middle == side.hi) {
      return {ImpactState::kHit, time.lo, impact.iterations};
    }
    assert(side.lo < middle && middle < side.hi);
    for (const bool upper : {true, false}) {
      ParameterBox half = cell;
      (upper ? half.side[widest].lo : half.side[widest].hi) = middle;
      push(half);
    }
  }
  impact.time = 1.0;
  return impact;
}

template <std::size_t N>
double largest(const std::array<MovingPoint, N>& points) {
  double most = 0.0;
  for (const MovingPoint& p : points) most = std::max({most, largest(p.at_0), largest(p.at_1)});
  return most;
}

}  // namespace

LinearImpact LinearImpactQuery::vertex_face(const MovingPoint& vertex, const std::array<MovingPoint, 3>& face,
                                            const ImpactOptions& options) {
  return first_root(VertexFace{vertex, face}, std::max(largest(std::array{vertex}), largest(face)), options, open_);
}

LinearImpact LinearImpactQuery::edge_edge(const std::array<MovingPoint, 2>& a, const std::array<MovingPoint, 2>& b,
                                          const ImpactOptions& options) {
  return first_root(EdgeEdge{a, b}, std::max(largest(a), largest(b)), options, open_);
}

LinearImpact vertex_face_impact(const MovingPoint& vertex, const std::array<MovingPoint, 3>& face,
                                const ImpactOptions& options) {
  return LinearImpactQuery().vertex_face(vertex, face, options);
}

LinearImpact edge_edge_impact(const std::array<MovingPoint, 2>& a, const std::array<MovingPoint, 2>& b,
                              const ImpactOptions& options) {
  return LinearImpactQuery().edge_edge(a, b, options);
}

}  // namespace peerd::collision
