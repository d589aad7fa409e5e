#include "collision/time_of_impact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "collision/triangle_distance.hpp"
#include "collision/wide_kernels.hpp"

namespace peerd::collision {

using Ref = WideTree::Ref;

Pose RigidMotion::at(double t_s) const {
  return {at_start.position + velocity * t_s, multiply(quat_exp(angular_velocity * t_s), at_start.orientation)};
}

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// No point of the soup is farther from its frame's origin.
double radius(const TriangleSoup& soup) {
  Vec3 far;
  for (int k = 0; k < 3; ++k) far[k] = std::max(std::abs(soup.box.lo[k]), std::abs(soup.box.hi[k]));
  return far.norm() * (1.0 + 0x1p-50);
}

struct Earlier {
  template <class Open>
  bool operator()(const Open& a, const Open& b) const {
    if (a.time_s != b.time_s) return a.time_s > b.time_s;
    // Triangles first: one of them may be the answer.
    if (a.triangles != b.triangles) return b.triangles;
    return a.a != b.a ? a.a > b.a : a.b > b.b;
  }
};

}  // namespace

// The step, and what is known of the instant at which pairs are looked at.
struct MeshImpactQuery::Step {
  WideTree &a, &b;
  const RigidMotion &motion_a, &motion_b;
  double end_s;
  double edge_m_s;   // no two points move faster by turning, together
  double bend_m_s2;  // nor do their velocities change faster
  double rounding_m_s;

  double time_s = -1.0;
  Pose pose_a, pose_b;
  RelativeMotion a_from_b{Pose{}, Pose{}};
  std::optional<WideMotion> wide;
  WideSpeeds speeds{};

  Step(WideTree& tree_a, const RigidMotion& of_a, WideTree& tree_b, const RigidMotion& of_b, double step_s)
      : a(tree_a), b(tree_b), motion_a(of_a), motion_b(of_b), end_s(step_s) {
    const double rate_a = of_a.angular_velocity.norm(), rate_b = of_b.angular_velocity.norm();
    const double edge_a = rate_a * radius(a.soup()), edge_b = rate_b * radius(b.soup());
    edge_m_s = (edge_a + edge_b) * (1.0 + 0x1p-40);
    bend_m_s2 = (rate_a * edge_a + rate_b * edge_b) * (1.0 + 0x1p-40);
    rounding_m_s = 0x1p-18 * (of_a.velocity.norm() + of_b.velocity.norm() + edge_a + edge_b);
    speeds.rate_a = static_cast<float>(rate_a * (1.0 + 0x1p-20));
    speeds.rate_b = static_cast<float>(rate_b * (1.0 + 0x1p-20));
  }

  // What velocities may change by from now on, on average over any part of the rest of the step.
  [[nodiscard]] double spare() const { return std::min(0.5 * bend_m_s2 * (end_s - time_s), 2.0 * edge_m_s); }

  void go_to(double t) {
    if (t == time_s) return;
    time_s = t;
    pose_a = motion_a.at(t);
    pose_b = motion_b.at(t);
    a_from_b = RelativeMotion(pose_a, pose_b);
    wide.emplace(a, b, a_from_b);
    fill(motion_a, pose_a, a.origin(), speeds.base_a, speeds.turn_a);
    fill(motion_b, pose_b, b.origin(), speeds.base_b, speeds.turn_b);
    speeds.spare_m_s = static_cast<float>((spare() + rounding_m_s) * (1.0 + 0x1p-20));
  }
  static void fill(const RigidMotion& motion, const Pose& pose, const Vec3& origin, std::array<float, 3>& base,
                   std::array<float, 3>& turn) {
    const Mat3 from_world = pose.orientation.toRotationMatrix().transpose();
    const Vec3 w = multiply(from_world, motion.angular_velocity);
    const Vec3 v = multiply(from_world, motion.velocity) + w.cross(origin);
    for (int k = 0; k < 3; ++k) {
      base[static_cast<std::size_t>(k)] = static_cast<float>(v[k]);
      turn[static_cast<std::size_t>(k)] = static_cast<float>(w[k]);
    }
  }

  // How long two triangles certainly don't meet: their gap along a direction (of A's frame, unit) over the speed at
  // which their corners close it. Along the direction of their nearest points that is all there is to know; where those
  // are rounded, it is still certain.
  [[nodiscard]] double delay(const Vec3& direction, const Triangle& of_a, const Triangle& of_b, double rounding) const {
    const Mat3 axes = pose_a.orientation.toRotationMatrix();
    const Vec3 n = multiply(axes, direction);
    const auto speed = [&](const RigidMotion& motion, const Pose& pose, const Vec3& in_a) {
      const Vec3 from_center = multiply(axes, in_a) + (pose_a.position - pose.position);
      return n.dot(motion.velocity + motion.angular_velocity.cross(from_center));
    };
    double last_a = -kInfinity, first_b = kInfinity, fastest_a = -kInfinity, slowest_b = kInfinity;
    for (std::size_t i = 0; i < 3; ++i) {
      last_a = std::max(last_a, direction.dot(of_a[i]));
      first_b = std::min(first_b, direction.dot(of_b[i]));
      fastest_a = std::max(fastest_a, speed(motion_a, pose_a, of_a[i]));
      slowest_b = std::min(slowest_b, speed(motion_b, pose_b, of_b[i]));
    }
    const double gap = first_b - last_a - rounding;
    const double closing = fastest_a - slowest_b + spare() + 0x1p-20 * rounding_m_s;
    return gap <= 0.0 ? 0.0 : closing <= 0.0 ? kInfinity : gap / closing;
  }

  // A place as eight boxes: the node's children, the leaf's triangles, or the leaf itself as one.
  enum class As : std::uint8_t { kChildren, kTriangles, kWhole };
  static WideTree::Node boxes(WideTree& tree, Ref ref, As as) {
    if (as == As::kChildren) return tree.node(ref.index());
    const WideTree::Leaf& leaf = tree.leaf(ref.index());
    if (as == As::kTriangles) return boxes_of(leaf);
    WideTree::Node node;
    for (std::size_t k = 0; k < 3; ++k) {
      node.center[k].fill(0.0f);
      node.half[k].fill(WideTree::kNoBox);
      node.center[k][0] = leaf.center[k];
      node.half[k][0] = leaf.half[k];
    }
    return node;
  }
};

MeshImpact MeshImpactQuery::first_impact(WideTree& a, const RigidMotion& motion_a, WideTree& b,
                                         const RigidMotion& motion_b, double step_s, const MeshImpactOptions& options) {
  MeshImpact impact;
  if (overlap_.find_pair(a, b, RelativeMotion(motion_a.at_start, motion_b.at_start), impact.pair)) {
    impact.state = MeshImpactState::kOverlapped;
    return impact;
  }
  if (a.scale() != 1.0 || b.scale() != 1.0) {
    impact.state = MeshImpactState::kFailed;
    return impact;
  }
  Step step(a, motion_a, b, motion_b, step_s);
  open_.clear();
  open_.push_back({0.0, WideTree::kRoot, WideTree::kRoot, false});
  const auto open_later = [&](const Open& pair) {
    if (!(pair.time_s <= step_s)) return;
    open_.push_back(pair);
    std::ranges::push_heap(open_, Earlier());
  };
  while (!open_.empty()) {
    std::ranges::pop_heap(open_, Earlier());
    const Open pair = open_.back();
    open_.pop_back();
    if (impact.iterations == options.most_iterations) {
      impact.state = MeshImpactState::kFailed;
      impact.time_s = pair.time_s;
      return impact;
    }
    ++impact.iterations;
    step.go_to(pair.time_s);
    const RelativeMotion& a_from_b = step.a_from_b;
    if (pair.triangles) {
      const Triangle in_b = b.soup().triangle(pair.b);
      const Triangle triangle_a = a.soup().triangle(pair.a);
      const Triangle triangle_b = {a_from_b(in_b[0]), a_from_b(in_b[1]), a_from_b(in_b[2])};
      const TriangleDistance found = triangle_distance(triangle_a, triangle_b);
      // Where the world's coordinates are large, places in it are known less well than the tolerance.
      const double rounding =
          0x1p-46 * (step.pose_a.position.cwiseAbs().maxCoeff() + step.pose_b.position.cwiseAbs().maxCoeff() +
                     a.extent_m() + b.extent_m() + a.origin().norm() + b.origin().norm());
      if (found.distance <= options.tolerance_m + rounding) {
        impact.state = MeshImpactState::kHit;
        impact.time_s = pair.time_s;
        impact.pair = {a.soup().faces[pair.a].polygon, b.soup().faces[pair.b].polygon};
        impact.distance_m = found.distance;
        return impact;
      }
      const Vec3 direction = (found.on_b - found.on_a) / found.distance;
      open_later({pair.time_s + step.delay(direction, triangle_a, triangle_b, rounding), pair.a, pair.b, true});
      continue;
    }
    using As = Step::As;
    const Ref of_a = a.at(pair.a), of_b = b.at(pair.b);
    const bool leaf_a = of_a.kind() == Ref::kLeaf, leaf_b = of_b.kind() == Ref::kLeaf;
    const As as_a = !leaf_a ? As::kChildren : leaf_b ? As::kTriangles : As::kWhole;
    const As as_b = !leaf_b ? As::kChildren : leaf_a ? As::kTriangles : As::kWhole;
    const WideTree::Node boxes_a = Step::boxes(a, of_a, as_a), boxes_b = Step::boxes(b, of_b, as_b);
    Delays delays;
    delays_of_nodes(boxes_a, boxes_b, *step.wide, step.speeds, delays);
    const auto name = [](WideTree& tree, Ref ref, std::uint32_t place, As as, std::size_t i) {
      return as == As::kChildren    ? WideTree::place(ref, i)
             : as == As::kTriangles ? tree.leaf(ref.index()).faces[i]
                                    : place;
    };
    for (std::size_t j = 0; j < WideTree::kWidth; ++j) {
      if (boxes_b.half[0][j] == WideTree::kNoBox) continue;
      for (std::size_t i = 0; i < WideTree::kWidth; ++i) {
        if (boxes_a.half[0][i] == WideTree::kNoBox) continue;
        open_later({pair.time_s + static_cast<double>(delays[j][i]), name(a, of_a, pair.a, as_a, i),
                    name(b, of_b, pair.b, as_b, j), leaf_a && leaf_b});
      }
    }
  }
  impact.time_s = step_s;
  return impact;
}

}  // namespace peerd::collision
