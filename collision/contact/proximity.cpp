#include "collision/contact/proximity.hpp"

#include <cassert>
#include <cmath>
#include <limits>

#include "collision/contact/contact_time.hpp"
#include "collision/exact/ordered_sums.hpp"
#include "collision/exact/quadratic.hpp"
#include "collision/query/mesh_distance.hpp"
#include "collision/query/time_of_impact.hpp"

namespace peerd::collision {
namespace {

MovingSphere bounding_sphere(const MovingBody& m) {
  return {m.motion.position + rotate(m.motion.orientation.toRotationMatrix(), m.body.center), m.motion.velocity,
          m.body.radius_m};
}

constexpr std::uint32_t kMaxIterations = 1024;

// These keep memory between calls, never values.
thread_local MeshImpactQuery proximity_impacts;
thread_local MeshDistanceQuery distances;

}  // namespace

double proximity_time_s(const MovingBody& p, const MovingBody& q) {
  return proximity_time_s(bounding_sphere(p), bounding_sphere(q));
}

double proximity_time_s(const MovingSphere& p, const MovingSphere& q) {
  const Vec3 d0 = q.center - p.center;
  const Vec3 u = q.velocity - p.velocity;
  const double r = p.radius_m + q.radius_m;
  assert(!(r < 0.0));
  const Quadratic apart{dot(d0, d0) - r * r, 2.0 * dot(d0, u), dot(u, u)};
  if (apart.c0 <= 0.0) return 0.0;
  const double d = discriminant(apart);
  if (apart.c2 == 0.0 || d < 0.0) return std::numeric_limits<double>::infinity();
  // Apart now, so both roots lie on the same side of 0: the nearer one is the answer.
  const auto [first, second] = roots(apart, d);
  assert(!(first > second));
  return first >= 0.0 ? first : -2.0 * second;
}

bool may_come_near(const MovingBody& p, const MovingBody& q, double within_s, double margin_m) {
  assert(margin_m >= 0.0 && within_s >= 0.0);
  if (!has_exact_answer(p.body, q.body)) return true;
  Surface &of_p = *p.body.surface, &of_q = *q.body.surface;
  if (of_p.soup().faces.empty() || of_q.soup().faces.empty()) return false;
  const MeshDistance now =
      distances.distance(of_p.tree(), of_q.tree(), RelativeMotion(p.motion.pose(), q.motion.pose()),
                         {.stop_above_m = margin_m, .stop_below_m = margin_m, .max_iterations = kMaxIterations});
  if (now.lower_m < margin_m) return true;
  const MeshImpact impact = proximity_impacts.first_impact(
      of_p.tree(), p.motion, of_q.tree(), q.motion, within_s,
      {.tolerance_m = 2.0 * margin_m, .max_iterations = kMaxIterations, .only_distance = true});
  return impact.state != MeshImpactState::kSeparated;
}

}  // namespace peerd::collision
