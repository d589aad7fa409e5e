#include "collision/time_of_impact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision/triangle_distance.hpp"
#include "collision/wide_kernels.hpp"

namespace peerd::collision {

using Ref = WideTree::Ref;

Pose RigidMotion::at(double t_s) const {
  return {at_start.position + velocity * t_s, multiply(quat_exp(angular_velocity * t_s), at_start.orientation)};
}

namespace {

// No point of the soup is farther from its frame's origin.
double radius(const TriangleSoup& soup) {
  Vec3 far;
  for (int k = 0; k < 3; ++k) far[k] = std::max(std::abs(soup.box.lo[k]), std::abs(soup.box.hi[k]));
  return far.norm() * (1.0 + 0x1p-50);
}

double gap_along(const Vec3& direction, const Triangle& a, const Triangle& b) {
  const auto at = [&](const Vec3& p) { return direction.dot(p); };
  return std::min({at(b[0]), at(b[1]), at(b[2])}) - std::max({at(a[0]), at(a[1]), at(a[2])});
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

// What is the same for the whole step, and the pose at which pairs are looked at.
struct MeshImpactQuery::Step {
  WideTree &a, &b;
  const RigidMotion &motion_a, &motion_b;
  Vec3 closing;    // of A towards B [m/s], world
  double turning;  // no point of either moves faster than this by its body's turning [m/s]

  Step(WideTree& tree_a, const RigidMotion& of_a, WideTree& tree_b, const RigidMotion& of_b)
      : a(tree_a),
        b(tree_b),
        motion_a(of_a),
        motion_b(of_b),
        closing(of_a.velocity - of_b.velocity),
        turning((of_a.angular_velocity.norm() * radius(tree_a.soup()) +
                 of_b.angular_velocity.norm() * radius(tree_b.soup())) *
                (1.0 + 0x1p-40)) {}

  // How fast a gap along a unit direction from A to B closes at most.
  [[nodiscard]] double speed_along(const Vec3& direction) const {
    return std::max(0.0, closing.dot(direction)) + turning + 0x1p-40 * closing.norm();
  }

  [[nodiscard]] ClosingTimes closing_times(const Pose& pose_a, const Pose& pose_b) const {
    ClosingTimes times{};
    const Mat3 axes_a = pose_a.orientation.toRotationMatrix(), axes_b = pose_b.orientation.toRotationMatrix();
    const auto reciprocal = [&](const Vec3& direction) {
      const double speed = speed_along(direction);
      // Not infinite, since nothing may become no number: 10^30 s to the metre will do for standing still.
      return static_cast<float>(std::min(1e30, (1.0 - 0x1p-20) / speed));
    };
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      times.in_a_positive[i] = reciprocal(axes_a.col(k));
      times.in_a_negative[i] = reciprocal(-axes_a.col(k));
      times.in_b_positive[i] = reciprocal(-axes_b.col(k));  // A on B's positive side: from A to B is the other way
      times.in_b_negative[i] = reciprocal(axes_b.col(k));
    }
    return times;
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
  const Step step(a, motion_a, b, motion_b);
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
    const Pose pose_a = motion_a.at(pair.time_s), pose_b = motion_b.at(pair.time_s);
    const RelativeMotion a_from_b(pose_a, pose_b);
    if (pair.triangles) {
      const Triangle in_b = b.soup().triangle(pair.b);
      const Triangle triangle_a = a.soup().triangle(pair.a);
      const Triangle triangle_b = {a_from_b(in_b[0]), a_from_b(in_b[1]), a_from_b(in_b[2])};
      const TriangleDistance found = triangle_distance(triangle_a, triangle_b);
      // Where the world's coordinates are large, places in it are known less well than the tolerance.
      const double rounding = 0x1p-46 * (pose_a.position.cwiseAbs().maxCoeff() + pose_b.position.cwiseAbs().maxCoeff() +
                                         a.extent_m() + b.extent_m() + a.origin().norm() + b.origin().norm());
      if (found.distance <= options.tolerance_m + rounding) {
        impact.state = MeshImpactState::kHit;
        impact.time_s = pair.time_s;
        impact.pair = {a.soup().faces[pair.a].polygon, b.soup().faces[pair.b].polygon};
        impact.distance_m = found.distance;
        return impact;
      }
      // The nearest points are rounded; the gap along their direction is certain, and as wide where they are right.
      const Vec3 direction = (found.on_b - found.on_a) / found.distance;
      const double gap = gap_along(direction, triangle_a, triangle_b) - rounding;
      open_later(
          {pair.time_s + std::max(0.0, gap) / step.speed_along(pose_a.orientation * direction), pair.a, pair.b, true});
      continue;
    }
    using As = Step::As;
    const Ref of_a = a.at(pair.a), of_b = b.at(pair.b);
    const bool leaf_a = of_a.kind() == Ref::kLeaf, leaf_b = of_b.kind() == Ref::kLeaf;
    const As as_a = !leaf_a ? As::kChildren : leaf_b ? As::kTriangles : As::kWhole;
    const As as_b = !leaf_b ? As::kChildren : leaf_a ? As::kTriangles : As::kWhole;
    const WideTree::Node boxes_a = Step::boxes(a, of_a, as_a), boxes_b = Step::boxes(b, of_b, as_b);
    Delays delays;
    delays_of_nodes(boxes_a, boxes_b, WideMotion(a, b, a_from_b), step.closing_times(pose_a, pose_b), delays);
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
