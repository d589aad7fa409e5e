#include "collision/volumes/enclosing_ball.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace peerd::collision {
namespace {

// Up to four points on the sphere of a ball.
struct BallSupport {
  std::array<Vec3, 4> points;
  int count = 0;
};

// The smallest ball with all points of the support on its sphere: its center is first + sum x_i (p_i - first), with
// (p_j - first) . (sum x_i (p_i - first)) = |p_j - first|^2 / 2.
EnclosingBall ball_through(const BallSupport& support) {
  if (support.count == 0) return {Vec3::Zero(), -1.0};
  const Vec3& first = support.points[0];
  if (support.count == 1) return {first, 0.0};
  const int n = support.count - 1;
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> edges(3, n);
  for (int i = 0; i < n; ++i) edges.col(i) = support.points[static_cast<std::size_t>(i) + 1] - first;
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3> gram = edges.transpose() * edges;
  const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> half = gram.diagonal() / 2.0;
  const Vec3 to_center = edges * gram.completeOrthogonalDecomposition().solve(half);
  return {first + to_center, to_center.norm()};
}

// A point that is farther out than by rounding would make a larger ball.
bool is_outside(const Vec3& p, const EnclosingBall& ball) {
  return ball.radius_m < 0.0 || (p - ball.center).norm() > ball.radius_m * (1.0 + 0x1p-40);
}

// The smallest ball around the first `count` points with the support on its sphere.
EnclosingBall ball_around(std::vector<Vec3>& points, std::size_t count, const BallSupport& support) {
  assert(support.count <= 4);
  EnclosingBall ball = ball_through(support);
  if (support.count == 4) return ball;
  for (std::size_t i = 0; i < count; ++i) {
    if (!is_outside(points[i], ball)) continue;
    BallSupport larger = support;
    larger.points[static_cast<std::size_t>(larger.count++)] = points[i];
    ball = ball_around(points, i, larger);
    const auto at = points.begin() + static_cast<std::ptrdiff_t>(i);
    std::rotate(points.begin(), at, at + 1);
  }
  return ball;
}

}  // namespace

EnclosingBall smallest_ball(std::span<const Vec3> points) {
  assert(!points.empty());
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) mean += p / static_cast<double>(points.size());
  std::vector<Vec3> order(points.begin(), points.end());
  std::ranges::stable_sort(order, std::greater<>(), [&](const Vec3& p) { return (p - mean).squaredNorm(); });
  EnclosingBall ball = ball_around(order, order.size(), {});
  ball.radius_m = 0.0;
  for (const Vec3& p : points) ball.radius_m = std::max(ball.radius_m, (p - ball.center).norm());
  return ball;
}

double volume(const EnclosingBall& ball) {
  return 4.0 / 3.0 * std::numbers::pi * ball.radius_m * ball.radius_m * ball.radius_m;
}

}  // namespace peerd::collision
