// Highway includes this file again and again, to compile it once for each instruction set.
#include "collision/query/wide_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/query/wide_view.cpp"
#include <hwy/foreach_target.h>  // NOLINT: before highway.h
#include <hwy/highway.h>
#include <cassert>

#include <algorithm>
#include <cmath>

#include "collision/query/wide_lanes.hpp"
#include "collision/query/wide_view.hpp"

HWY_BEFORE_NAMESPACE();
namespace peerd::collision::HWY_NAMESPACE {

// Slabs. What is no number hits nothing, and only boxes that aren't there come to that.
std::uint8_t TestRayNode(const WideTree::Node& node, const WideRay& ray, Entries& entries) {
  std::uint32_t out = 0;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    V entry = set(ray.first), exit = set(ray.last);
    for (std::size_t k = 0; k < 3; ++k) {
      const V middle = hn::Mul(hn::Sub(load(node.center[k], i), set(ray.start[k])), set(ray.inverse[k]));
      const V reach = hn::Mul(hn::Add(load(node.half[k], i), set(ray.slack)), set(std::abs(ray.inverse[k])));
      entry = hn::Max(entry, hn::Sub(middle, reach));
      exit = hn::Min(exit, hn::Add(middle, reach));
    }
    store(entry, entries, i);
    out |= bits(hn::Le(entry, exit), i);
  }
  return static_cast<std::uint8_t>(out);
}

// Corners are moved along the ray to a plane across its main axis, where the ray is the origin: Woop, Benthin and Wald,
// "Watertight Ray/Triangle Intersection", JCGT 2 (2013). There, it is certainly outside where one edge has it certainly
// on one side and another on the other.
std::uint8_t TestRayLeaf(const WideTree::Leaf& leaf, const WideRay& ray) {
  std::uint32_t out = 0;
  const auto [x, y, main] = std::array{ray.axes[1], ray.axes[2], ray.axes[0]};
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    std::array<V, 3> along, px, py;
    V size = hn::Zero(Lanes());
    for (std::size_t c = 0; c < 3; ++c) {
      const auto from_start = [&](std::size_t k) {
        return hn::Sub(load(leaf.corners[c][k], i), set(ray.start[k] - leaf.center[k]));
      };
      along[c] = from_start(main);
      px[c] = hn::Sub(from_start(x), hn::Mul(set(ray.shear_x), along[c]));
      py[c] = hn::Sub(from_start(y), hn::Mul(set(ray.shear_y), along[c]));
      size = hn::Max(size, hn::Max(hn::Abs(px[c]), hn::Abs(py[c])));
    }
    // Twice an area errs by 4 size * slack + 2 slack^2 and by the rounding of its two products.
    const V slack = set(ray.moved_slack);
    const V margin =
        hn::Add(hn::Mul(hn::Add(size, slack), hn::Add(hn::Mul(set(4.2f), slack), hn::Mul(set(0x1p-21f), size))),
                set(0x1p-120f));
    const auto area = [&](std::size_t a, std::size_t b) {
      return hn::Sub(hn::Mul(px[a], py[b]), hn::Mul(px[b], py[a]));
    };
    const V d = area(0, 1), e = area(1, 2), f = area(2, 0);
    const V least = hn::Min(hn::Min(d, e), f), most = hn::Max(hn::Max(d, e), f);
    const V p = hn::Mul(along[0], set(ray.per_main)), q = hn::Mul(along[1], set(ray.per_main)),
            r = hn::Mul(along[2], set(ray.per_main));
    const auto outside = hn::And(hn::Lt(least, hn::Neg(margin)), hn::Gt(most, margin));
    const auto beyond =
        hn::Or(hn::Gt(hn::Min(hn::Min(p, q), r), set(ray.last)), hn::Lt(hn::Max(hn::Max(p, q), r), set(ray.first)));
    out |= bits(hn::Not(hn::Or(outside, beyond)), i);
  }
  return static_cast<std::uint8_t>(out & ((1u << leaf.count) - 1));
}

// Combines the planes of `active`: distances() gives the least and the greatest distance of what is in each lane from a
// plane. Planes that a lane isn't certainly inside of are noted for lanes in view alone.
template <class Distances>
HWY_INLINE std::uint8_t test_planes(const WidePlanes& planes, PlaneMask active, std::array<PlaneMask, kWidth>& crossed,
                                    Distances distances) {
  using Ints = hn::RebindToSigned<Lanes>;
  std::uint32_t out = 0;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    auto in_view = hn::FirstN(Lanes(), kWidth);
    auto noted = hn::Zero(Ints());
    for (std::uint32_t rest = active; rest != 0 && !hn::AllFalse(Lanes(), in_view); rest &= rest - 1) {
      const WidePlanes::Plane& plane = planes.planes[hwy::Num0BitsBelowLS1Bit_Nonzero32(rest)];
      const auto [least, most] = distances(plane, i);
      const auto inside = hn::RebindMask(Ints(), hn::Ge(least, set(plane.slack)));
      const auto bit = hn::Set(Ints(), static_cast<std::int32_t>(rest & (~rest + 1)));
      in_view = hn::And(in_view, hn::Ge(most, set(-plane.slack)));
      noted = hn::Or(noted, hn::IfThenZeroElse(inside, bit));
    }
    const auto of_these = hn::IfThenElseZero(hn::RebindMask(Ints(), in_view), noted);
    hn::StoreU(hn::DemoteTo(hn::Rebind<PlaneMask, Lanes>(), of_these), hn::Rebind<PlaneMask, Lanes>(), &crossed[i]);
    out |= bits(in_view, i);
  }
  return static_cast<std::uint8_t>(out);
}

struct Interval {
  V least, most;
};
HWY_INLINE V distance(const V3& normal, const V3& p, const WidePlanes::Plane& plane) {
  return hn::Add(dot(normal, p), set(plane.offset));
}
HWY_INLINE V3 normal_of(const WidePlanes::Plane& plane) {
  return {set(plane.normal[0]), set(plane.normal[1]), set(plane.normal[2])};
}

std::uint8_t TestPlanesNode(const WideTree::Node& node, const WidePlanes& planes, PlaneMask active,
                            std::array<PlaneMask, kWidth>& crossed) {
  return test_planes(planes, active, crossed, [&](const WidePlanes::Plane& plane, std::size_t i) {
    const V3 normal = normal_of(plane);
    const V middle = distance(normal, load3(node.center, i), plane);
    const V reach = dot({hn::Abs(normal.x), hn::Abs(normal.y), hn::Abs(normal.z)}, load3(node.half, i));
    return Interval{hn::Sub(middle, reach), hn::Add(middle, reach)};
  });
}

std::uint8_t TestPlanesLeaf(const WideTree::Leaf& leaf, const WidePlanes& planes, PlaneMask active,
                            std::array<PlaneMask, kWidth>& crossed) {
  const std::uint8_t out = test_planes(planes, active, crossed, [&](const WidePlanes::Plane& plane, std::size_t i) {
    const V3 normal = normal_of(plane);
    const auto& n = plane.normal;
    const V middle = set(((n[0] * leaf.center[0] + n[1] * leaf.center[1]) + n[2] * leaf.center[2]) + plane.offset);
    const Corners corners = load_corners(leaf.corners, i);
    const V p = dot(normal, corners.p), q = dot(normal, corners.q), r = dot(normal, corners.r);
    return Interval{hn::Add(middle, hn::Min(hn::Min(p, q), r)), hn::Add(middle, hn::Max(hn::Max(p, q), r))};
  });
  return static_cast<std::uint8_t>(out & ((1u << leaf.count) - 1));
}

}  // namespace peerd::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace peerd::collision {

HWY_EXPORT(TestRayNode);
HWY_EXPORT(TestRayLeaf);
HWY_EXPORT(TestPlanesNode);
HWY_EXPORT(TestPlanesLeaf);

// With E the tree's extent, the start is within 1.75 E (and some slack) of the tree's origin, or all is missed; so
// lengths along the ray are below 10 E, and each of the roundings of a slab's test is below 2^-24 of 4 E, the
// direction's below 2^-24 of 10 E: together they are below a half of 2^-18 E. The rounding of binary64, in which the
// start is found, matters only far from the origins.
WideRay::WideRay(const WideTree& tree, const Ray& ray) : scale_(tree.scale()) {
  int exponent = 0;
  (void)std::frexp(ray.direction.cwiseAbs().maxCoeff(), &exponent);
  unit_ = std::ldexp(1.0, exponent);
  const auto sum = [](const Vec3& a, const Vec3& b) { return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]; };
  const Vec3 direction(std::ldexp(ray.direction[0], -exponent), std::ldexp(ray.direction[1], -exponent),
                       std::ldexp(ray.direction[2], -exponent));
  nearest_ = std::max(0.0, sum(tree.origin() - ray.origin, direction) / sum(direction, direction));
  const Vec3 from = ((ray.origin - tree.origin()) + nearest_ * direction) * scale_;
  const double binary64 =
      0x1p-46 * (ray.origin.cwiseAbs().maxCoeff() + tree.origin().cwiseAbs().maxCoeff() + nearest_) * scale_;
  const double extent = tree.extent_m() * scale_;
  const double slack64 = 0x1p-18 * extent + binary64 + 0x1p-120;
  const double reach = 1.75 * extent + 4.0 * slack64;
  reaches_tree_ = sum(from, from) <= reach * reach;
  if (!reaches_tree_) return;
  slack = static_cast<float>(slack64);
  moved_slack = static_cast<float>(0x1p-19 * extent + 4.0 * binary64 + 0x1p-120);
  std::size_t main = 0;
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    start[i] = static_cast<float>(from[k]);
    // A direction that turns by less than 2^-30 errs by less than the slack.
    inverse[i] = static_cast<float>(1.0 / std::copysign(std::max(std::abs(direction[k]), 0x1p-30), direction[k]));
    if (std::abs(direction[k]) > std::abs(direction[static_cast<int>(main)])) main = i;
  }
  axes = {main, (main + 1) % 3, (main + 2) % 3};
  const double along = direction[static_cast<int>(main)];
  shear_x = static_cast<float>(direction[static_cast<int>(axes[1])] / along);
  shear_y = static_cast<float>(direction[static_cast<int>(axes[2])] / along);
  per_main = static_cast<float>(1.0 / along);
  constexpr double kFar = 0x1p100;
  first = static_cast<float>(std::max(-nearest_ * scale_ - 4.0 * slack64, -kFar));
  shorten(ray.longest);
}

void WideRay::shorten(double longest) {
  constexpr double kFar = 0x1p100;  // beyond all trees, on their scale
  const double t = longest * unit_;
  const double end = (t - nearest_) * scale_ + (4.0 * static_cast<double>(slack) + 0x1p-50 * (t + nearest_) * scale_);
  assert(t >= 0.0);
  last = static_cast<float>(std::clamp(end, -kFar, kFar));
}

std::uint8_t test_ray_node(const WideTree::Node& node, const WideRay& ray, Entries& entries) {
  return HWY_DYNAMIC_DISPATCH(TestRayNode)(node, ray, entries);
}
std::uint8_t test_ray_leaf(const WideTree::Leaf& leaf, const WideRay& ray) {
  return HWY_DYNAMIC_DISPATCH(TestRayLeaf)(leaf, ray);
}
std::uint8_t test_planes_node(const WideTree::Node& node, const WidePlanes& planes, PlaneMask active,
                              std::array<PlaneMask, WideTree::kWidth>& crossed) {
  return HWY_DYNAMIC_DISPATCH(TestPlanesNode)(node, planes, active, crossed);
}
std::uint8_t test_planes_leaf(const WideTree::Leaf& leaf, const WidePlanes& planes, PlaneMask active,
                              std::array<PlaneMask, WideTree::kWidth>& crossed) {
  return HWY_DYNAMIC_DISPATCH(TestPlanesLeaf)(leaf, planes, active, crossed);
}

}  // namespace peerd::collision
#endif
