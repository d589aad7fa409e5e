#include "collision/exact/linear_impact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "collision/exact/orientation.hpp"

namespace peerd::collision {
namespace {

struct Interval {
  double lo = 0.0, hi = 1.0;  // multiples of a power of two, so halving is exact
  [[nodiscard]] double width() const { return hi - lo; }
};

// Of time and the two coordinates.
struct ParameterBox {
  std::array<Interval, 3> side;
};

// The first in time first, then the largest: its halves say more.
struct Later {
  bool operator()(const ParameterBox& a, const ParameterBox& b) const {
    const double ta = a.side[0].lo, tb = b.side[0].lo;
    if (ta != tb) return ta > tb;
    const auto size = [](const ParameterBox& c) {
      return std::max({c.side[0].width(), c.side[1].width(), c.side[2].width()});
    };
    return size(a) < size(b);
  }
};

Vec3 at(const MovingPoint& p, double t) { return p.at_0 * (1.0 - t) + p.at_1 * t; }

// What is to be 0: a vector that is linear in each of (t, u, v).
struct VertexFace {
  const MovingPoint& vertex;
  const std::array<MovingPoint, 3>& face;

  [[nodiscard]] Vec3 operator()(double t, double u, double v) const {
    const Vec3 a = at(face[0], t), b = at(face[1], t), c = at(face[2], t);
    return at(vertex, t) - ((a + (b - a) * u) + (c - a) * v);
  }
  // Beyond the third edge. u and v are exact, and so is their sum: 53 bits hold it.
  [[nodiscard]] bool outside(const ParameterBox& cell) const { return cell.side[1].lo + cell.side[2].lo > 1.0; }
};

struct EdgeEdge {
  const std::array<MovingPoint, 2>& a;
  const std::array<MovingPoint, 2>& b;

  [[nodiscard]] Vec3 operator()(double t, double u, double v) const {
    const Vec3 p = at(a[0], t), q = at(b[0], t);
    return (p + (at(a[1], t) - p) * u) - (q + (at(b[1], t) - q) * v);
  }
  [[nodiscard]] bool outside(const ParameterBox&) const { return false; }
};

double largest(const Vec3& v) { return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}); }

template <class Distance>
LinearImpact first_root(const Distance& distance, double largest_coordinate, const ImpactOptions& options) {
  // Some 20 roundings of numbers of at most three times the largest coordinate.
  const double rounding = 128.0 * kUnitRoundoff * largest_coordinate;
  // How far the image's corners move along each side: the side to halve is the one with the widest image.
  std::array<double, 3> reach = {0.0, 0.0, 0.0};
  for (int corner = 0; corner < 8; ++corner) {
    for (std::size_t side = 0; side < 3; ++side) {
      if ((corner >> side & 1) != 0) continue;
      const auto value = [&](int c) { return distance(c & 1, c >> 1 & 1, c >> 2 & 1); };
      reach[side] = std::max(reach[side], largest(value(corner | 1 << side) - value(corner)));
    }
  }
  std::vector<ParameterBox> open = {ParameterBox{}};
  LinearImpact impact;
  while (!open.empty()) {
    std::ranges::pop_heap(open, Later());
    const ParameterBox cell = open.back();
    open.pop_back();
    if (impact.iterations == options.max_iterations) return {ImpactState::kUnsure, cell.side[0].lo, impact.iterations};
    ++impact.iterations;
    if (distance.outside(cell)) continue;
    Vec3 least = Vec3::Constant(std::numeric_limits<double>::infinity()), most = -least;
    for (int corner = 0; corner < 8; ++corner) {
      const auto end = [&](std::size_t side) {
        return (corner >> side & 1) != 0 ? cell.side[side].hi : cell.side[side].lo;
      };
      const Vec3 value = distance(end(0), end(1), end(2));
      least = least.cwiseMin(value);
      most = most.cwiseMax(value);
    }
    if (least.maxCoeff() > rounding || most.minCoeff() < -rounding) continue;
    const bool small = (most - least).maxCoeff() <= std::max(options.tolerance_m, 4.0 * rounding);
    std::size_t widest = 0;
    for (std::size_t side = 1; side < 3; ++side) {
      if (reach[side] * cell.side[side].width() > reach[widest] * cell.side[widest].width()) widest = side;
    }
    const Interval& side = cell.side[widest];
    const double middle = side.lo + side.width() / 2.0;
    if (small || middle == side.lo || middle == side.hi) return {ImpactState::kHit, cell.side[0].lo, impact.iterations};
    for (const bool upper : {true, false}) {
      ParameterBox& half = open.emplace_back(cell);
      (upper ? half.side[widest].lo : half.side[widest].hi) = middle;
      std::ranges::push_heap(open, Later());
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

LinearImpact vertex_face_impact(const MovingPoint& vertex, const std::array<MovingPoint, 3>& face,
                                const ImpactOptions& options) {
  return first_root(VertexFace{vertex, face}, std::max(largest(std::array{vertex}), largest(face)), options);
}

LinearImpact edge_edge_impact(const std::array<MovingPoint, 2>& a, const std::array<MovingPoint, 2>& b,
                              const ImpactOptions& options) {
  return first_root(EdgeEdge{a, b}, std::max(largest(a), largest(b)), options);
}

}  // namespace peerd::collision
