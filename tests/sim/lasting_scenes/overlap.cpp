#include "tests/sim/lasting_scenes/overlap.hpp"

#include <algorithm>
#include <limits>

namespace peerd::sim::lasting_scenes {
namespace {

using Mat3 = Eigen::Matrix3d;

struct Placed {
  const Part& part;
  Vec3 centre;
  Mat3 turned;
};

Placed placed(const Part& part, const Pose& pose) {
  const Mat3 turned = pose.orientation.toRotationMatrix();
  return {part, pose.position + turned * part.offset_m, turned};
}

double reach(const Placed& box, const Vec3& along) {
  return (box.turned.transpose() * along).cwiseAbs().dot(box.part.half_m);
}

// The separating axis theorem: the least depth over the axes of faces and of pairs of edges.
double of_boxes(const Placed& a, const Placed& b) {
  double least = std::numeric_limits<double>::infinity();
  const Vec3 apart = b.centre - a.centre;
  const auto look_along = [&](Vec3 axis) {
    const double length = axis.norm();
    if (length < 1e-6) return;  // edges that are parallel: the faces' axes stand for them
    axis /= length;
    least = std::min(least, reach(a, axis) + reach(b, axis) - std::abs(axis.dot(apart)));
  };
  for (int i = 0; i < 3; ++i) {
    look_along(a.turned.col(i));
    look_along(b.turned.col(i));
    for (int k = 0; k < 3; ++k) look_along(a.turned.col(i).cross(b.turned.col(k)));
  }
  return least;
}

double of_ball_and_box(const Placed& ball, const Placed& box) {
  const Vec3 at = box.turned.transpose() * (ball.centre - box.centre);
  const Vec3 beyond = at.cwiseAbs() - box.part.half_m;
  if (beyond.maxCoeff() <= 0.0) return ball.part.radius_m - beyond.maxCoeff();
  return ball.part.radius_m - beyond.cwiseMax(0.0).norm();
}

double of_parts(const Placed& a, const Placed& b) {
  const bool a_is_ball = a.part.radius_m > 0.0, b_is_ball = b.part.radius_m > 0.0;
  if (a_is_ball && b_is_ball) return a.part.radius_m + b.part.radius_m - (a.centre - b.centre).norm();
  if (a_is_ball) return of_ball_and_box(a, b);
  if (b_is_ball) return of_ball_and_box(b, a);
  return of_boxes(a, b);
}

double out_of_room(const Placed& room, const Placed& in) {
  double out = -std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 along = room.turned.col(axis);
    const double extent = in.part.radius_m > 0.0 ? in.part.radius_m : reach(in, along);
    out = std::max(out, std::abs(along.dot(in.centre - room.centre)) + extent - room.part.half_m[axis]);
  }
  return out;
}

}  // namespace

double overlap_m(const Body& a, const Pose& at_a, const Body& b, const Pose& at_b) {
  double deepest = -std::numeric_limits<double>::infinity();
  for (const Part& p : a.parts) {
    for (const Part& q : b.parts) {
      const Placed one = placed(p, at_a), other = placed(q, at_b);
      const bool in_a = a.encloses && p.half_m.x() > q.half_m.cwiseMax(q.radius_m).x();
      const bool in_b = b.encloses && q.half_m.x() > p.half_m.cwiseMax(p.radius_m).x();
      deepest = std::max(deepest, in_a   ? out_of_room(one, other)
                                  : in_b ? out_of_room(other, one)
                                         : of_parts(one, other));
    }
  }
  return deepest;
}

}  // namespace peerd::sim::lasting_scenes
