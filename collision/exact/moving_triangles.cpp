#include "collision/exact/moving_triangles.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "collision/exact/infinity.hpp"
#include "collision/exact/ordered_sums.hpp"
#include "collision/exact/orientation.hpp"
#include "collision/exact/triangle_distance.hpp"

namespace peerd::collision {
namespace {

constexpr double kBeyond = 2.0;  // a time after all that are sought
// More than the few roundings of a quotient, and room for those that are subnormal.
constexpr double kQuotientRounding = 0x1p-50;
constexpr double kUnderflowOfQuotient = 0x1p-1000;

// The end of the stretch of time, from t on, in which a line through (0, g0) and (1, g1) is above 0: rounded down; t
// where it is not certainly above 0 just after t.
double positive_until(double g0, double g1, double t) {
  if (g0 > 0.0 && g1 > 0.0) return kBeyond;
  if (g0 > 0.0) return std::max(t, g0 / (g0 - g1) * (1.0 - kQuotientRounding) - kUnderflowOfQuotient);
  if (g1 > 0.0 && t > -g0 / (g1 - g0) * (1.0 + kQuotientRounding) + kUnderflowOfQuotient) return kBeyond;
  return t;
}

Vec3 place(const MovingPoint& p, double t) { return p.at_0 * (1.0 - t) + p.at_1 * t; }
Triangle place(const MovingTriangle& triangle, double t) {
  return {place(triangle[0], t), place(triangle[1], t), place(triangle[2], t)};
}

WorldBox box_at(const MovingTriangle& triangle, Vec3 MovingPoint::*end) {
  WorldBox box;
  for (const MovingPoint& corner : triangle) box.merge(corner.*end);
  return box;
}

// An order that does not depend on which triangle a caller names first.
bool before(const MovingTriangle& a, const MovingTriangle& b) {
  for (std::size_t corner = 0; corner < 3; ++corner) {
    for (const auto end : {&MovingPoint::at_0, &MovingPoint::at_1}) {
      for (int k = 0; k < 3; ++k) {
        const double of_a = (a[corner].*end)[k], of_b = (b[corner].*end)[k];
        if (of_a != of_b) return of_a < of_b;
      }
    }
  }
  return false;
}

// The question about one pair, its corners taken from an origin in their middle: rounding is then of the pair's size,
// not of its place. Taking a corner there rounds it by 2^-53 of that size along each axis.
class Advancement {
 public:
  Advancement(const MovingTriangle& a, const MovingTriangle& b, const MovingTriangleOptions& options)
      : options_(options), a_(a), b_(b) {
    WorldBox all = swept_box(a);
    all.merge(swept_box(b));
    const Vec3 origin = all.lo / 2.0 + all.hi / 2.0;
    for (MovingTriangle* const triangle : {&a_, &b_}) {
      for (MovingPoint& corner : *triangle) {
        corner.at_0 -= origin;
        corner.at_1 -= origin;
        size_m_ = std::max({size_m_, corner.at_0.cwiseAbs().maxCoeff(), corner.at_1.cwiseAbs().maxCoeff()});
      }
    }
    tolerance_m_ = std::max(options.tolerance_m, 0x1p-42 * size_m_);
    assert(std::isfinite(size_m_) && std::isfinite(tolerance_m_));
  }

  // Advances from a time before which nothing is as near as the margin. Then `time` is another such time, and the state
  // is kUnsure where it is not known how it goes on from there.
  LinearImpact advance(double t) const {
    assert(t >= 0.0 && t <= 1.0);
    const double near_m = options_.margin_m + tolerance_m_;
    // Places at a time are off by the shift, 1 - t, two products and a sum: 5 u of the size along each axis, of both.
    const double off_m = 32.0 * kUnitRoundoff * size_m_;
    LinearImpact impact;
    while (true) {
      const Triangle a = place(a_, t), b = place(b_, t);
      const TriangleDistance gap = triangle_distance(a, b, kDirectionAccuracy * tolerance_m_ / near_m);
      const double next = free_until(t, a, b, gap.on_b - gap.on_a);
      assert(next >= t);
      // A pair that is near and certainly stays apart to the end, beside something or on its way off, is no hit. This
      // is about the end rather than about options_.last, lest a hit depend on that.
      if (next > options_.last && (next > 1.0 || gap.upper + off_m > near_m))
        return {ImpactState::kSeparated, 1.0, impact.iterations};
      if (gap.upper + off_m <= near_m) return {ImpactState::kHit, t, impact.iterations};
      if (impact.iterations == options_.max_steps || next == t) break;
      ++impact.iterations;
      t = next;
    }
    return {ImpactState::kUnsure, t, impact.iterations};
  }

  // The inclusion tests, from a time at which the triangles are apart.
  LinearImpact include(LinearImpactQuery& query, double t) const {
    // The room that those tests leave for rounding is less than the tolerance.
    ImpactOptions options{.tolerance_m = tolerance_m_,
                          .max_iterations = options_.max_iterations,
                          .margin_m = options_.margin_m,
                          .begin = t,
                          .last = options_.last};
    LinearImpact first;
    const auto consider = [&](const LinearImpact& found) {
      first.iterations += found.iterations;
      if (found.state == ImpactState::kSeparated) return;
      const bool known = first.state != ImpactState::kSeparated;
      if (known && (found.time > first.time || (found.time == first.time && found.state == ImpactState::kUnsure)))
        return;
      first.state = found.state;
      options.last = first.time = found.time;
    };
    for (const MovingPoint& corner : a_) consider(query.vertex_face(corner, b_, options));
    for (const MovingPoint& corner : b_) consider(query.vertex_face(corner, a_, options));
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        consider(query.edge_edge({a_[i], a_[(i + 1) % 3]}, {b_[j], b_[(j + 1) % 3]}, options));
      }
    }
    return first;
  }

 private:
  // Places of nearest points need not be accurate for the direction between them to be good.
  static constexpr double kDirectionAccuracy = 0.125;

  // A time until which the triangles, apart at t, certainly stay farther apart than the margin: the last that one of
  // the directions between them has.
  double free_until(double t, const Triangle& a, const Triangle& b, const Vec3& nearest) const {
    double until = free_along(nearest, t);
    const auto go = [&](const Vec3& u, const Vec3& v) {
      if (until > 1.0) return;
      const Vec3 n = u.cross(v);
      until = std::max({until, free_along(n, t), free_along(-n, t)});
    };
    for (const Triangle* face : {&a, &b}) go((*face)[1] - (*face)[0], (*face)[2] - (*face)[0]);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) go(a[(i + 1) % 3] - a[i], b[(j + 1) % 3] - b[j]);
    }
    return until;
  }

  // A time until which the gap of each corner of B to each corner of A along a direction stays above the margin; t
  // where it isn't above it now. The direction may be any: it is not rounded but taken as it is.
  //
  // Divided by its largest component, a direction has a length in [1, 1.8]. A product of it with a corner is below 3
  // times the size; the shift, the product and the differences that follow are rounded by below 50 u of size and
  // margin.
  double free_along(const Vec3& direction, double t) const {
    const double most = direction.cwiseAbs().maxCoeff();
    if (!(most > 0.0 && most < kInfinity)) return t;
    const Vec3 n = direction / most;
    const double room = options_.margin_m * length(n) * (1.0 + 0x1p-50) +
                        128.0 * kUnitRoundoff * (size_m_ + options_.margin_m) + kUnderflowOfQuotient;
    std::array<double, 3> a_0, a_1;
    for (std::size_t i = 0; i < 3; ++i) {
      a_0[i] = dot(n, a_[i].at_0);
      a_1[i] = dot(n, a_[i].at_1);
    }
    double until = kBeyond;
    for (std::size_t j = 0; j < 3; ++j) {
      const double b_0 = dot(n, b_[j].at_0), b_1 = dot(n, b_[j].at_1);
      for (std::size_t i = 0; i < 3; ++i) {
        until = std::min(until, positive_until(b_0 - a_0[i] - room, b_1 - a_1[i] - room, t));
        if (until <= t) return t;
      }
    }
    return until;
  }

  const MovingTriangleOptions& options_;
  MovingTriangle a_, b_;
  double size_m_ = 0.0;  // the largest coordinate
  double tolerance_m_ = 0.0;
};

}  // namespace

WorldBox swept_box(const MovingTriangle& triangle) {
  WorldBox box = box_at(triangle, &MovingPoint::at_0);
  box.merge(box_at(triangle, &MovingPoint::at_1));
  return box;
}

// The lower side of a triangle's box is concave in time, and the upper one convex, so that the gap of two boxes along
// an axis is at least the line between its values at 0 and 1.
std::optional<double> first_box_contact(const MovingTriangle& a, const MovingTriangle& b, double margin_m) {
  if (!boxes_near(swept_box(a), swept_box(b), margin_m)) return std::nullopt;
  const WorldBox a_0 = box_at(a, &MovingPoint::at_0), a_1 = box_at(a, &MovingPoint::at_1);
  const WorldBox b_0 = box_at(b, &MovingPoint::at_0), b_1 = box_at(b, &MovingPoint::at_1);
  const auto gap = [&](const WorldBox& lower, const WorldBox& upper, int k) {
    const double difference = upper.lo[k] - lower.hi[k];
    return difference - margin_m - (4.0 * kUnitRoundoff * (std::abs(difference) + margin_m) + kUnderflowOfQuotient);
  };
  double from = 0.0, until = 1.0;
  for (int k = 0; k < 3; ++k) {
    for (const bool a_is_lower : {true, false}) {
      const double g0 = a_is_lower ? gap(a_0, b_0, k) : gap(b_0, a_0, k);
      const double g1 = a_is_lower ? gap(a_1, b_1, k) : gap(b_1, a_1, k);
      if (g0 > 0.0) {
        from = std::max(from, positive_until(g0, g1, 0.0));
      } else if (g1 > 0.0) {
        until = std::min(until, -g0 / (g1 - g0) * (1.0 + kQuotientRounding) + kUnderflowOfQuotient);
      }
    }
  }
  if (from > until) return std::nullopt;
  assert(from >= 0.0 && from <= 1.0);
  return from;
}

LinearImpact MovingTriangleQuery::first_impact(const MovingTriangle& a, const MovingTriangle& b,
                                               const MovingTriangleOptions& options) {
  assert(options.margin_m >= 0.0 && options.tolerance_m > 0.0 && options.last >= 0.0 && options.last <= 1.0);
  const std::optional<double> from = first_box_contact(a, b, options.margin_m);
  if (!from || *from > options.last) return {};
  const bool swapped = before(b, a);
  const Advancement pair(swapped ? b : a, swapped ? a : b, options);
  LinearImpact impact = pair.advance(*from);
  if (impact.state != ImpactState::kUnsure) return impact;
  const std::uint32_t steps = impact.iterations;
  impact = pair.include(inclusion_, impact.time);
  impact.iterations += steps;
  return impact;
}

}  // namespace peerd::collision
