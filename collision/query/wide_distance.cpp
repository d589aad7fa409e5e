// Highway includes this file again and again, to compile it once for each instruction set.
#include "collision/query/wide_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/query/wide_distance.cpp"
#include <hwy/foreach_target.h>  // NOLINT: before highway.h
#include <hwy/highway.h>
#include <cassert>

#include <algorithm>
#include <cmath>

#include "collision/query/wide_chosen.hpp"
#include "collision/query/wide_distance.hpp"
#include "collision/query/wide_nearest.hpp"

HWY_BEFORE_NAMESPACE();
namespace peerd::collision::HWY_NAMESPACE {

// A lower bound of the length of three gaps. Where their squares over- or underflow, it is the largest of them.
HWY_INLINE V gap_length(V x, V y, V z) {
  const V square = dot({x, y, z}, {x, y, z});
  const V length = hn::IfThenElseZero(hn::Gt(square, set(0x1p-100f)), hn::Mul(hn::Sqrt(square), set(kRoundedDown)));
  return hn::Max(known(length), hn::Max(hn::Max(x, y), z));
}
HWY_INLINE V gap_of_boxes(const V3& center_a, const V3& half_a, const V3& center_b, const V3& half_b) {
  const auto along = [](V ca, V ha, V cb, V hb) { return known(hn::Sub(hn::Abs(hn::Sub(ca, cb)), hn::Add(ha, hb))); };
  return gap_length(along(center_a.x, half_a.x, center_b.x, half_b.x),
                    along(center_a.y, half_a.y, center_b.y, half_b.y),
                    along(center_a.z, half_a.z, center_b.z, half_b.z));
}

HWY_INLINE std::uint32_t first_bits(std::size_t count) { return (1u << count) - 1; }

// Files the lanes from i on of a row of lower bounds.
HWY_INLINE void record(V lower, V most, std::uint32_t count_a, std::size_t row, std::size_t i, Distances& out) {
  store(lower, out.lower[row], i);
  const std::uint32_t lanes = first_bits(hn::Lanes(Lanes())) << i;
  const std::uint32_t below = bits(hn::Lt(lower, most), i) & lanes & first_bits(count_a);
  out.below[row] = static_cast<std::uint8_t>((out.below[row] & ~lanes) | below);
}
// The least that is filed and not below `most`.
HWY_INLINE float least_skipped(std::uint32_t count_a, std::uint32_t count_b, float most, const Distances& distances) {
  constexpr Row kNumbers = {0, 1, 2, 3, 4, 5, 6, 7};
  const V none = set(std::numeric_limits<float>::infinity());
  V least = none;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const auto there = hn::Lt(load(kNumbers, i), set(static_cast<float>(count_a)));
    for (std::size_t row = 0; row < count_b; ++row) {
      const V lower = load(distances.lower[row], i);
      least = hn::Min(least, hn::IfThenElse(hn::And(there, hn::Ge(lower, set(most))), lower, none));
    }
  }
  return hn::GetLane(hn::MinOfLanes(Lanes(), least));
}

// Along the line of the centers n, which is n_b in B's frame: n^2 less how far the boxes reach along it, over its
// length. n_b is off the turned n by two places' rounding, so B's reach by 4 slacks times its size over |n|: for boxes
// that are no larger than they are apart, that and the places' own are below 8.
HWY_INLINE V gap_along_centers(const V3& center_a, const V3& half_a, const V3& center_a_in_b, const V3& center_b_in_a,
                               const V3& half_b, const V3& center_b, V a_from_b, float slack) {
  const auto reach = [](const V3& half, const V3& n) { return dot(half, {hn::Abs(n.x), hn::Abs(n.y), hn::Abs(n.z)}); };
  const V3 n = minus(center_b_in_a, center_a), n_b = minus(center_b, center_a_in_b);
  const V square = dot(n, n);
  const V gap = hn::Sub(hn::Sub(square, reach(half_a, n)), hn::Mul(hn::Mul(reach(half_b, n_b), a_from_b), a_from_b));
  const V certain = hn::Sub(hn::Mul(hn::Div(gap, hn::Sqrt(square)), set(kRoundedDown)), set(8.0f * slack));
  const V size_b = hn::Mul(hn::Add(hn::Add(half_b.x, half_b.y), half_b.z), a_from_b);
  const auto good = hn::And(hn::Gt(square, set(0x1p-100f)), hn::Le(hn::Mul(size_b, size_b), square));
  return hn::IfThenElseZero(good, known(certain));
}

// Lower bounds of the distances of oriented boxes: the length of their gaps along A's axes, or along B's, or the gap
// along the line of their centers, t. The slack is that of one axis; errors along the line of centers are at most
// sqrt(3) times as large, so it takes two.
HWY_INLINE V distance_of_oriented_boxes(const OrientedBoxes& a, const OrientedBoxes& b, V slack) {
  const SeparatingAxes f(a, b);
  const auto gap = [&](V distance, V reach)
                       HWY_ATTR { return known(hn::Sub(hn::Abs(distance), hn::Add(reach, slack))); };
  const V t_b[3] = {f.along_b<0>(f.t), f.along_b<1>(f.t), f.along_b<2>(f.t)};
  const V along_a = gap_length(gap(f.t[0], f.reach_along_a<0>()), gap(f.t[1], f.reach_along_a<1>()),
                               gap(f.t[2], f.reach_along_a<2>()));
  const V along_b = gap_length(gap(t_b[0], f.reach_along_b<0>()), gap(t_b[1], f.reach_along_b<1>()),
                               gap(t_b[2], f.reach_along_b<2>()));
  const V square = dot({f.t[0], f.t[1], f.t[2]}, {f.t[0], f.t[1], f.t[2]});
  const V reach = hn::Add(dot(a.half, {hn::Abs(f.t[0]), hn::Abs(f.t[1]), hn::Abs(f.t[2])}),
                          dot(b.half, {hn::Abs(t_b[0]), hn::Abs(t_b[1]), hn::Abs(t_b[2])}));
  const V line =
      hn::Sub(hn::Mul(hn::Div(hn::Sub(square, reach), hn::Sqrt(square)), set(kRoundedDown)), hn::Add(slack, slack));
  const V known_line = hn::IfThenElseZero(hn::Gt(square, set(0x1p-100f)), known(line));
  return hn::Max(hn::Max(along_a, along_b), known_line);
}

void DistancesOfNodes(const WideTree::Node& a, std::uint32_t count_a, const WideTree::Node& b, std::uint32_t count_b,
                      const WideMotion& m, float most, Distances& out) {
  MovedBoxes moved;
  move_boxes(b, m, moved);
  out.below.fill(0);
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const V3 center = load3(a.center, i), half = load3(a.half, i);
    for (std::size_t row = 0; row < count_b; ++row) {
      const auto along = [&](V at, V reach, std::size_t k) HWY_ATTR {
        const V ahead = hn::Sub(set(moved.lo[k][row]), at), behind = hn::Sub(at, set(moved.hi[k][row]));
        return known(hn::Sub(hn::Max(ahead, behind), reach));
      };
      record(gap_length(along(center.x, half.x, 0), along(center.y, half.y, 1), along(center.z, half.z, 2)), set(most),
             count_a, row, i, out);
    }
  }
  std::uint64_t near = 0;
  for (std::size_t row = 0; row < count_b; ++row) near |= static_cast<std::uint64_t>(out.below[row]) << (kWidth * row);
  while (near != 0) {
    const ChosenLanes chosen = take_lanes(near);
    Row lower;
    store(distance_of_oriented_boxes(chosen_boxes(a.oriented_center, a.oriented_half, a.axes, RowLookup<true>(chosen)),
                                     chosen_boxes(moved.center, b.oriented_half, moved.axes, RowLookup<false>(chosen)),
                                     set(m.slack_oriented)),
          lower, 0);
    for (std::size_t lane = 0; chosen.present >> lane != 0; ++lane) {
      const std::uint8_t pair = pair_at(chosen, lane);
      const std::size_t i = LanePairs::of_a(pair), row = LanePairs::of_b(pair);
      float& bound = out.lower[row][i];
      bound = std::max(bound, lower[lane]);
      if (!(bound < most)) out.below[row] = static_cast<std::uint8_t>(out.below[row] & ~(1u << i));
    }
  }
  out.skipped = least_skipped(count_a, count_b, most, out);
}

// Soups so large that binary32 could overflow, or of two scales: boxes with the axes of either frame.
void DistancesOfLargeNodes(const WideTree::Node& a, std::uint32_t count_a, const WideTree::Node& b,
                           std::uint32_t count_b, const WideMotion& m, float most, Distances& out) {
  Boxes b_in_a, a_in_b;
  to_a(b, m, b_in_a);
  to_b(a, m, a_in_b);
  out.below.fill(0);
  const V a_from_b = set(m.scale_a_from_b), largest = set(std::numeric_limits<float>::max());
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const V3 center_a = load3(a.center, i), half_a = load3(a.half, i);
    const V3 center_in_b = load3(a_in_b.center, i), half_in_b = load3(a_in_b.half, i);
    for (std::size_t row = 0; row < count_b; ++row) {
      const V in_a = gap_of_boxes(center_a, half_a, set3(b_in_a.center, row), set3(b_in_a.half, row));
      const V in_b = gap_of_boxes(center_in_b, half_in_b, set3(b.center, row), set3(b.half, row));
      // The bound is 0 where the other scale makes a subnormal number of it, which may be rounded up.
      const V scaled_b = hn::Min(hn::Mul(in_b, a_from_b), largest);
      const V in_b_known = hn::IfThenElseZero(hn::Gt(scaled_b, set(0x1p-100f)), scaled_b);
      const V line = gap_along_centers(center_a, half_a, center_in_b, set3(b_in_a.center, row), set3(b.half, row),
                                       set3(b.center, row), a_from_b, m.slack_a);
      record(hn::Max(line, hn::Max(in_a, in_b_known)), set(most), count_a, row, i, out);
    }
  }
  out.skipped = least_skipped(count_a, count_b, most, out);
}

// A direction from A to B, in A's frame. Its length is known well enough not to round up what is divided by it.
struct Direction {
  std::array<float, 3> n;
  float inverse;  // 0 where it has none
};
HWY_INLINE Direction direction(const std::array<float, 3>& n) {
  const float square = (n[0] * n[0] + n[1] * n[1]) + n[2] * n[2];
  const bool good = square > 0x1p-100f && square < 0x1p100f;
  return {n, good ? kRoundedDown / std::sqrt(square) : 0.0f};
}

// The extents of the triangles along the direction, from `origin`: the last of A's, the first of B's.
HWY_INLINE V along(const Direction& d, const V3& p, const V3& origin) {
  return dot({set(d.n[0]), set(d.n[1]), set(d.n[2])}, minus(p, origin));
}
HWY_INLINE V last_along(const Direction& d, const Corners& t, const V3& origin) {
  return hn::Max(hn::Max(along(d, t.p, origin), along(d, t.q, origin)), along(d, t.r, origin));
}
HWY_INLINE V first_along(const Direction& d, const Corners& t, const V3& origin) {
  return hn::Min(hn::Min(along(d, t.p, origin), along(d, t.q, origin)), along(d, t.r, origin));
}

void DistancesOfLeaves(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& m,
                       const std::array<float, 3>& guess, float most, Distances& out,
                       std::array<Row, kWidth>& estimates) {
  std::array<float, 3> center, half;
  transform(b, m.a_from_b, m.a_from_b_sizes, m.b_in_a, m.slack_a, center, half);
  const std::array<Direction, 2> directions = {
      direction(guess), direction({center[0] - a.center[0], center[1] - a.center[1], center[2] - a.center[2]})};
  const V3 origin{set(a.center[0]), set(a.center[1]), set(a.center[2])};
  std::array<Rows, 3> in_a;
  std::array<Row, 2> firsts;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const Corners corners = moved(load_corners(b, i), m);
    store_corners(corners, in_a, i);
    for (std::size_t n = 0; n < 2; ++n) store(first_along(directions[n], corners, origin), firsts[n], i);
  }
  out.below.fill(0);
  const V slack = set(3.0f * m.slack_a);
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const Corners corners = load_corners(a, i);
    const std::array<V, 2> lasts = {last_along(directions[0], corners, origin),
                                    last_along(directions[1], corners, origin)};
    std::uint32_t open = 0;
    for (std::size_t row = 0; row < b.count; ++row) {
      const auto gap = [&](std::size_t n) {
        return known(hn::Sub(hn::Mul(hn::Sub(set(firsts[n][row]), lasts[n]), set(directions[n].inverse)), slack));
      };
      record(hn::Max(gap(0), gap(1)), set(most), a.count, row, i, out);
      open |= out.below[row];
    }
    if (open >> i == 0) continue;
    const Shape shape_a = shape(corners);
    for (std::size_t row = 0; row < b.count; ++row) {
      if (out.below[row] >> i == 0) continue;
      const Shape shape_b = shape(set_corners(in_a, row));
      const Shortest found = shortest(shape_a, shape_b);
      const V before = load(out.lower[row], i), gap = gap_along(found, corners, shape_b.corners, m.slack_a);
      // Lanes that were not requested are left out, however many lanes there are: so counters are the same on every
      // machine.
      const V lower = hn::Max(before, hn::IfThenElseZero(hn::Lt(before, set(most)), gap));
      record(lower, set(most), a.count, row, i, out);
      store(hn::Sqrt(found.square), estimates[row], i);
    }
  }
  out.skipped = least_skipped(a.count, b.count, most, out);
}

}  // namespace peerd::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace peerd::collision {

HWY_EXPORT(DistancesOfNodes);
HWY_EXPORT(DistancesOfLargeNodes);
HWY_EXPORT(DistancesOfLeaves);

void distances_of_nodes(const WideTree::Node& a, std::uint32_t count_a, const WideTree::Node& b, std::uint32_t count_b,
                        const WideMotion& motion, float most, Distances& distances) {
  assert(count_a >= 1 && count_a <= WideTree::kWidth && count_b >= 1 && count_b <= WideTree::kWidth);
  if (motion.in_range) {
    HWY_DYNAMIC_DISPATCH(DistancesOfNodes)(a, count_a, b, count_b, motion, most, distances);
  } else {
    HWY_DYNAMIC_DISPATCH(DistancesOfLargeNodes)(a, count_a, b, count_b, motion, most, distances);
  }
}
void distances_of_leaves(const WideTree::Leaf& a, const WideTree::Leaf& b, const WideMotion& motion,
                         const std::array<float, 3>& guess, float most, Distances& distances, DistanceRows& estimates) {
  assert(a.count >= 1 && b.count >= 1);
  HWY_DYNAMIC_DISPATCH(DistancesOfLeaves)(a, b, motion, guess, most, distances, estimates);
}

}  // namespace peerd::collision
#endif
