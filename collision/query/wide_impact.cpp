// Highway includes this file again and again, to compile it once for each instruction set.
#include "collision/query/wide_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/query/wide_impact.cpp"
#include <hwy/foreach_target.h>  // NOLINT: before highway.h
#include <hwy/highway.h>
#include <cassert>

#include <algorithm>
#include <cmath>

#include "collision/query/wide_chosen.hpp"
#include "collision/query/wide_impact.hpp"
#include "collision/query/wide_nearest.hpp"

HWY_BEFORE_NAMESPACE();
namespace peerd::collision::HWY_NAMESPACE {

// The velocities of the centers of oriented boxes, in A's frame, and how much faster other points in them are at most.
struct Velocities {
  Rows v;
  Row spread;
};
template <class ToA>
HWY_INLINE void velocities(const WideTree::Node& node, const std::array<float, 3>& linear,
                           const std::array<float, 3>& angular, float rate, ToA to_a, Velocities& out) {
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const V3 half = load3(node.oriented_half, i);
    store3(to_a(plus(cross(set3(angular), load3(node.oriented_center, i)), linear)), out.v, i);
    store(hn::Mul(set(rate), hn::Sqrt(dot(half, half))), out.spread, i);
  }
}

// The pairs of boxes whose gap along A's axes may close.
HWY_INLINE std::uint64_t pairs_that_may_meet(const WideTree::Node& a, const WideTree::Node& b, const MovedBoxes& moved,
                                             const Velocities& of_a, const Velocities& of_b, const WideSpeeds& s,
                                             float within_s) {
  std::uint64_t near = 0;
  const V within = set(within_s), zero = hn::Zero(Lanes());
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const V3 center = load3(a.center, i), half = load3(a.half, i), v = load3(of_a.v, i);
    const V spread = load(of_a.spread, i);
    const auto there = hn::Ge(half.x, zero);
    for (std::size_t row = 0; row < kWidth; ++row) {
      if (b.half[0][row] < 0.0f) break;
      const V spare = hn::Mul(hn::Add(spread, set(of_b.spread[row] + s.slack_m_s)), within);
      // Boxes of which one is ahead by a gap, and stays so.
      const auto along = [&](V at, V reach, V speed, std::size_t k) HWY_ATTR {
        const V way = hn::Mul(hn::Sub(speed, set(of_b.v[k][row])), within);  // by which A comes after B
        const V ahead = hn::Sub(hn::Sub(set(moved.lo[k][row]), at), reach);
        const V behind = hn::Sub(hn::Sub(at, reach), set(moved.hi[k][row]));
        return hn::Or(hn::Gt(ahead, hn::Max(hn::Add(way, spare), zero)),
                      hn::Gt(behind, hn::Max(hn::Sub(spare, way), zero)));
      };
      const auto apart = hn::Or(hn::Or(along(center.x, half.x, v.x, 0), along(center.y, half.y, v.y, 1)),
                                along(center.z, half.z, v.z, 2));
      near |= static_cast<std::uint64_t>(bits(hn::AndNot(apart, there), i)) << (kWidth * row);
    }
  }
  return near;
}

// Boxes stay apart where they have a gap along one of the axes that isn't closed in time: at `velocity`, A's less B's,
// and at most by `spare` faster.
HWY_INLINE auto stay_apart(const OrientedBoxes& a, const OrientedBoxes& b, const V3& velocity, V spare, V slack,
                           V within) {
  const SeparatingAxes f(a, b);
  const V speed[3] = {dot(a.axes[0], velocity), dot(a.axes[1], velocity), dot(a.axes[2], velocity)};
  const auto along = [&](V distance, V reach, V closing) HWY_ATTR {
    const V gap = hn::Sub(hn::Abs(distance), hn::Add(reach, slack));
    const V toward = hn::Add(hn::Xor(closing, hn::And(distance, hn::SignBit(Lanes()))), spare);
    return hn::Gt(gap, hn::Max(hn::Mul(toward, within), hn::Zero(Lanes())));
  };
  const auto of_a = [&]<std::size_t i>() HWY_ATTR { return along(f.t[i], f.reach_along_a<i>(), speed[i]); };
  const auto of_b = [&]<std::size_t j>()
                        HWY_ATTR { return along(f.along_b<j>(f.t), f.reach_along_b<j>(), f.along_b<j>(speed)); };
  const auto across = [&]<std::size_t i, std::size_t j>() HWY_ATTR {
    return along(f.along_product<i, j>(f.t), f.reach_along_product<i, j>(), f.along_product<i, j>(speed));
  };
  const auto across_a = [&]<std::size_t i>() HWY_ATTR {
    return hn::Or(hn::Or(across.template operator()<i, 0>(), across.template operator()<i, 1>()),
                  across.template operator()<i, 2>());
  };
  const auto faces = hn::Or(
      hn::Or(hn::Or(of_a.template operator()<0>(), of_a.template operator()<1>()), of_a.template operator()<2>()),
      hn::Or(hn::Or(of_b.template operator()<0>(), of_b.template operator()<1>()), of_b.template operator()<2>()));
  if (hn::AllTrue(Lanes(), faces)) return faces;
  return hn::Or(faces, hn::Or(hn::Or(across_a.template operator()<0>(), across_a.template operator()<1>()),
                              across_a.template operator()<2>()));
}

void NodesMayMeet(const WideTree::Node& a, const WideTree::Node& b, const WideMotion& m, const WideSpeeds& s,
                  float within_s, Masks& masks) {
  MovedBoxes moved;
  move_boxes(b, m, moved);
  Velocities of_a, of_b;
  const auto same = [](const V3& v) { return v; };
  const auto turned = [&](const V3& v) { return times(m.a_from_b, v); };
  velocities(a, s.linear_velocity_a, s.angular_velocity_a, s.rate_a, same, of_a);
  velocities(b, s.linear_velocity_b, s.angular_velocity_b, s.rate_b, turned, of_b);
  masks.fill(0);
  const V slack = set(m.slack_oriented), within = set(within_s);
  for (std::uint64_t near = pairs_that_may_meet(a, b, moved, of_a, of_b, s, within_s); near != 0;) {
    const ChosenLanes chosen = take_lanes(near);
    const RowLookup<true> in_a(chosen);
    const RowLookup<false> in_b(chosen);
    const V spare = hn::Add(hn::Add(in_a(of_a.spread), in_b(of_b.spread)), set(s.slack_m_s));
    const auto apart = stay_apart(chosen_boxes(a.oriented_center, a.oriented_half, a.axes, in_a),
                                  chosen_boxes(moved.center, b.oriented_half, moved.axes, in_b),
                                  minus(in_a(of_a.v), in_b(of_b.v)), spare, slack, within);
    for (std::uint32_t left = bits(hn::Not(apart), 0) & chosen.present; left != 0; left &= left - 1) {
      const std::uint8_t pair = pair_at(chosen, hwy::Num0BitsBelowLS1Bit_Nonzero32(left));
      std::uint8_t& mask = masks[LanePairs::of_b(pair)];
      mask = static_cast<std::uint8_t>(mask | 1u << LanePairs::of_a(pair));
    }
  }
}

// The corners of eight triangles, one to a lane, after they have moved on at their present velocities.
HWY_INLINE Corners advanced(const Corners& at, const std::array<float, 3>& base, const std::array<float, 3>& turn,
                            float within_s) {
  const V3 axis{set(turn[0]), set(turn[1]), set(turn[2])};
  const V within = set(within_s);
  const auto later = [&](const V3& p) {
    const V3 v = plus(cross(axis, p), base);
    return V3{hn::Add(p.x, hn::Mul(v.x, within)), hn::Add(p.y, hn::Mul(v.y, within)),
              hn::Add(p.z, hn::Mul(v.z, within))};
  };
  return {later(at.p), later(at.q), later(at.r)};
}

// The intervals that triangles occupy along a direction, now and later.
struct SweptInterval {
  V low, high, low_later, high_later;
};
// The interval of three corners' coordinates along a direction.
HWY_INLINE SweptInterval swept_interval_of(const V3& now, const V3& later) {
  return {hn::Min(hn::Min(now.x, now.y), now.z), hn::Max(hn::Max(now.x, now.y), now.z),
          hn::Min(hn::Min(later.x, later.y), later.z), hn::Max(hn::Max(later.x, later.y), later.z)};
}
HWY_INLINE SweptInterval swept_interval_along(const V3& n, const Corners& now, const Corners& later) {
  return swept_interval_of({dot(n, now.p), dot(n, now.q), dot(n, now.r)},
                           {dot(n, later.p), dot(n, later.q), dot(n, later.r)});
}

HWY_INLINE V coordinate(const V3& p, std::size_t k) { return k == 0 ? p.x : k == 1 ? p.y : p.z; }
// Along an axis.
HWY_INLINE SweptInterval swept_interval_of(const Corners& now, const Corners& later, std::size_t k) {
  return swept_interval_of({coordinate(now.p, k), coordinate(now.q, k), coordinate(now.r, k)},
                           {coordinate(later.p, k), coordinate(later.q, k), coordinate(later.r, k)});
}
HWY_INLINE V farthest_of(const SweptInterval& reach) {
  return hn::Max(hn::Max(hn::Abs(reach.low), hn::Abs(reach.high)),
                 hn::Max(hn::Abs(reach.low_later), hn::Abs(reach.high_later)));
}

// True where more than `margin` is between two intervals, now and later, on the same side. Corners move along straight
// lines between the two, so the gap is a concave function of time, and is there in between as well.
HWY_INLINE auto apart_along(const SweptInterval& a, const SweptInterval& b, V margin) {
  const auto ahead = [&](const SweptInterval& low, const SweptInterval& high) {
    return hn::And(hn::Gt(hn::Sub(high.low, low.high), margin),
                   hn::Gt(hn::Sub(high.low_later, low.high_later), margin));
  };
  return hn::Or(ahead(a, b), ahead(b, a));
}
// For intervals that aren't apart for all of the time: the part of it for which they certainly are, since the gap is
// above its chord.
HWY_INLINE V part_apart(const SweptInterval& a, const SweptInterval& b, V margin) {
  const auto ahead = [&](const SweptInterval& low, const SweptInterval& high) {
    const V now = hn::Sub(high.low, low.high), after = hn::Sub(high.low_later, low.high_later);
    const V spare = hn::Sub(now, margin);
    const V part = hn::Mul(hn::Div(spare, hn::Sub(now, after)), set(1.0f - 0x1p-20f));
    const auto is_part = hn::And(hn::Gt(spare, hn::Zero(Lanes())), hn::Le(part, set(1.0f)));  // a number, too
    return hn::IfThenElseZero(is_part, part);
  };
  return hn::Max(ahead(a, b), ahead(b, a));
}

// The intervals of triangles, one to a lane, along x, y and z.
struct SweptIntervals {
  Rows low, high, low_later, high_later;
};
HWY_INLINE void store_swept_interval(const SweptInterval& reach, SweptIntervals& out, std::size_t k, std::size_t i) {
  store(reach.low, out.low[k], i), store(reach.high, out.high[k], i);
  store(reach.low_later, out.low_later[k], i), store(reach.high_later, out.high_later[k], i);
}
HWY_INLINE SweptInterval set_swept_interval(const SweptIntervals& from, std::size_t k, std::size_t lane) {
  return {set(from.low[k][lane]), set(from.high[k][lane]), set(from.low_later[k][lane]), set(from.high_later[k][lane])};
}

// The interval that the box of a leaf's triangles occupies along an axis, and a bound of how far from the origin that
// is.
struct SweptBox {
  float low, high, low_later, high_later, far;
};
HWY_INLINE SweptBox swept_interval_of(const WideTree::Leaf& leaf, const std::array<float, 3>& base,
                                      const std::array<float, 3>& turn, float rate, float within_s, std::size_t k) {
  const std::size_t x = (k + 1) % 3, y = (k + 2) % 3;
  const float way = (base[k] + (turn[x] * leaf.center[y] - turn[y] * leaf.center[x])) * within_s;
  const float more = (rate * ((leaf.half[0] + leaf.half[1]) + leaf.half[2])) * within_s;
  const float low = leaf.center[k] - leaf.half[k], high = leaf.center[k] + leaf.half[k];
  const float far = std::abs(leaf.center[k]) + leaf.half[k] + std::abs(way) + more;
  return {low, high, (low + way) - more, (high + way) + more, far};
}

// The planes of eight triangles, in rows.
struct PlaneRows {
  Rows normal;
  Row size;
};
HWY_INLINE PlaneRows plane_rows(const std::array<Rows, 3>& corners) {
  PlaneRows rows;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const Planes plane = planes(load_corners(corners, i));
    store(plane.normal.x, rows.normal[0], i), store(plane.normal.y, rows.normal[1], i);
    store(plane.normal.z, rows.normal[2], i), store(plane.size, rows.size, i);
  }
  return rows;
}

void LeavesMayMeet(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& m, const WideSpeeds& s,
                   float within_s, Masks& masks, MeetTimes& times) {
  masks.fill(0);
  const SweptBox box_a[3] = {swept_interval_of(a, s.linear_velocity_a, s.angular_velocity_a, s.rate_a, within_s, 0),
                             swept_interval_of(a, s.linear_velocity_a, s.angular_velocity_a, s.rate_a, within_s, 1),
                             swept_interval_of(a, s.linear_velocity_a, s.angular_velocity_a, s.rate_a, within_s, 2)};
  const float far_box = std::max({box_a[0].far, box_a[1].far, box_a[2].far});
  // The error of corners that doesn't grow with their coordinates: that of the change of their velocities, for one.
  const V off_anywhere = set(2.0f * m.slack_a + s.slack_m_s * within_s), off_of_far = set(0x1p-19f);
  std::array<Rows, 3> corners, later;
  SweptIntervals reaches;
  Row far;
  std::uint32_t rows = 0;  // of B's triangles: those that A's box may meet
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const Corners own = load_corners(b, i);
    const Corners here = moved(own, m),
                  there = moved(advanced(own, s.linear_velocity_b, s.angular_velocity_b, within_s), m);
    store_corners(here, corners, i);
    store_corners(there, later, i);
    const SweptInterval of_b[3] = {swept_interval_of(here, there, 0), swept_interval_of(here, there, 1),
                                   swept_interval_of(here, there, 2)};
    const V farthest = hn::Max(hn::Max(farthest_of(of_b[0]), farthest_of(of_b[1])), farthest_of(of_b[2]));
    const V off = hn::Add(off_anywhere, hn::Mul(hn::Add(set(far_box), farthest), off_of_far));
    auto apart = hn::Lt(off, hn::Zero(Lanes()));  // none yet
    for (std::size_t k = 0; k < 3; ++k) {
      store_swept_interval(of_b[k], reaches, k, i);
      const SweptBox& of_a = box_a[k];
      apart = hn::Or(
          apart, apart_along({set(of_a.low), set(of_a.high), set(of_a.low_later), set(of_a.high_later)}, of_b[k], off));
    }
    store(farthest, far, i);
    rows |= bits(hn::Not(apart), i);
  }
  rows &= (1u << b.count) - 1;
  if (rows == 0) return;
  const auto [normal, size] = plane_rows(corners);
  const std::uint32_t present = (1u << a.count) - 1;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const Corners here = load_corners(a, i),
                  there = advanced(here, s.linear_velocity_a, s.angular_velocity_a, within_s);
    const SweptInterval of_a[3] = {swept_interval_of(here, there, 0), swept_interval_of(here, there, 1),
                                   swept_interval_of(here, there, 2)};
    const V far_a = hn::Max(hn::Max(farthest_of(of_a[0]), farthest_of(of_a[1])), farthest_of(of_a[2]));
    const Planes plane = planes(here);
    const SweptInterval across_a = swept_interval_along(plane.normal, here, there);
    Shape shape_a;
    bool has_shape = false;
    for (std::size_t row = 0; row < b.count; ++row) {
      if ((rows >> row & 1) == 0) continue;
      const V off = hn::Add(off_anywhere, hn::Mul(hn::Add(far_a, set(far[row])), off_of_far));
      auto apart = hn::Lt(off, hn::Zero(Lanes()));  // none yet
      for (std::size_t k = 0; k < 3; ++k)
        apart = hn::Or(apart, apart_along(of_a[k], set_swept_interval(reaches, k, row), off));
      if (hn::AllTrue(Lanes(), apart)) continue;
      const Corners other = set_corners(corners, row), other_later = set_corners(later, row);
      const auto along = [&](const V3& n, const SweptInterval& reach_a, V n_size, V& part) {
        const SweptInterval reach_b = swept_interval_along(n, other, other_later);
        const V margin = certain_margin(n_size, off);
        part = part_apart(reach_a, reach_b, margin);
        apart = hn::Or(apart, apart_along(reach_a, reach_b, margin));
      };
      V part_a, part_b, part_line;
      const V3 n = set3(normal, row);
      along(plane.normal, across_a, plane.size, part_a);
      along(n, swept_interval_along(n, here, there), set(size[row]), part_b);
      // Most of what is left is apart along the line of their nearest points.
      if (hn::AllTrue(Lanes(), apart)) continue;
      if (!has_shape) shape_a = shape(here);
      has_shape = true;
      const V3 line = shortest(shape_a, shape(other)).gap;
      const V length = hn::Add(hn::Add(hn::Abs(line.x), hn::Abs(line.y)), hn::Abs(line.z));  // at least that
      along(line, swept_interval_along(line, here, there), length, part_line);
      store(hn::Mul(hn::Max(hn::Max(part_a, part_b), part_line), set(within_s)), times[row], i);
      masks[row] = static_cast<std::uint8_t>(masks[row] | (bits(hn::Not(apart), i) & present));
    }
  }
}

}  // namespace peerd::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace peerd::collision {

HWY_EXPORT(NodesMayMeet);
HWY_EXPORT(LeavesMayMeet);

void nodes_may_meet(const WideTree::Node& a, const WideTree::Node& b, const WideMotion& motion,
                    const WideSpeeds& speeds, float within_s, Masks& masks) {
  assert(motion.in_range && !(within_s < 0.0f) && !(speeds.slack_m_s < 0.0f));
  HWY_DYNAMIC_DISPATCH(NodesMayMeet)(a, b, motion, speeds, within_s, masks);
}
void leaves_may_meet(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& motion,
                     const WideSpeeds& speeds, float within_s, Masks& masks, MeetTimes& times) {
  assert(!(within_s < 0.0f) && a.count >= 1 && b.count >= 1);
  HWY_DYNAMIC_DISPATCH(LeavesMayMeet)(a, b, motion, speeds, within_s, masks, times);
}

}  // namespace peerd::collision
#endif
