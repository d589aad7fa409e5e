#include "bench/impact/checks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace peerd::bench::impact {

using collision::MeshDistance;
using collision::MeshImpact;
using collision::MeshImpactState;
using collision::PolygonPair;
using collision::RelativeMotion;
using collision::WideTree;

namespace {

constexpr int kEvenly = 200;  // samples over the step, whatever moves
constexpr int kCloser = 48;   // before a time of impact, each nearer to it by half
constexpr int kBisections = 60;
constexpr double kParts = 200.0;  // of the smaller mesh: what touches for longer than it takes to go one is not missed

// Velocity of the material at a place in A's frame [m/s], world.
Vec3 velocity_at(const KinematicState& of, const Vec3& p_world) {
  const Vec3 turn_world = of.orientation * of.angular_velocity_body;
  return of.velocity + turn_world.cross(p_world - of.position);
}

}  // namespace

class Checker::Case {
 public:
  Case(Checker& checker, const MovingPair& pair)
      : checker_(checker), pair_(pair), tree_a_(pair.a.soup), tree_b_(pair.b.soup) {}

  Judgement run() {
    out_.impact = checker_.impacts_.first_impact(tree_a_, pair_.a.motion, tree_b_, pair_.b.motion, pair_.step_s,
                                                 {.tolerance_m = pair_.tolerance_m});
    const MeshImpactState state = out_.impact.state;
    out_.wrong_start = touch(0.0) != (state == MeshImpactState::kOverlapped);
    if (out_.wrong_start || state == MeshImpactState::kOverlapped || state == MeshImpactState::kTooLarge) return out_;
    const double until = out_.impact.time_s;
    for (int i = 1; i <= kEvenly; ++i) try_before(pair_.step_s * i / kEvenly, until);
    for (int k = 1; k <= kCloser; ++k) try_before(until * (1.0 - std::ldexp(1.0, -k)), until);
    if (state == MeshImpactState::kSeparated) try_before(until, std::numeric_limits<double>::infinity());
    walk(until);
    if (state == MeshImpactState::kHit && !out_.false_negative) judge_hit();
    return out_;
  }

 private:
  [[nodiscard]] RelativeMotion motion(double t) const {
    return {advance(pair_.a.motion, t).pose(), advance(pair_.b.motion, t).pose()};
  }
  bool touch(double t) {
    PolygonPair pair{};
    ++out_.samples;
    return checker_.exact_.find_pair(tree_a_, tree_b_, motion(t), pair);
  }
  MeshDistance distance(double t, double relative, double stop_above_m = std::numeric_limits<double>::infinity()) {
    return checker_.distances_.distance(tree_a_, tree_b_, motion(t),
                                        {.relative_accuracy = relative, .stop_above_m = stop_above_m});
  }

  void try_before(double t, double until) {
    if (t >= until || out_.false_negative || !touch(t)) return;
    out_.false_negative = true;
    out_.touches_s = t;
  }

  // No two points approach faster between t and the end of the step.
  [[nodiscard]] double fastest(double t) const {
    const KinematicState &a = pair_.a.motion, &b = pair_.b.motion;
    const auto between = [&](double at) {
      return Vec3(advance(a, at).velocity - advance(b, at).velocity).norm();  // convex in time
    };
    return std::max(between(t), between(pair_.step_s)) + a.angular_velocity_body.norm() * radius_m(pair_.a.soup) +
           b.angular_velocity_body.norm() * radius_m(pair_.b.soup);
  }

  // The walk goes on, where meshes are apart, by the time that their gap takes to close, but never by less than a part
  // of the smaller mesh takes: a contact that lasts longer than that is not missed.
  void walk(double until) {
    const double small = std::min(radius_m(pair_.a.soup), radius_m(pair_.b.soup));
    const double least =
        std::max(small / kParts, fastest(0.0) * pair_.step_s / static_cast<double>(checker_.most_samples_));
    for (double t = 0.0; t < until && !out_.false_negative;) {
      const double speed = fastest(t);
      if (speed == 0.0) return;
      const double gap = distance(t, 0.5).lower_m;
      t += std::max(gap, least) / speed;
      try_before(t, until);
    }
  }

  void judge_hit() {
    const double t = out_.impact.time_s;
    const KinematicState a = advance(pair_.a.motion, t), b = advance(pair_.b.motion, t);
    const MeshDistance found = distance(t, 0.0);
    const double places =
        a.position.lpNorm<1>() + b.position.lpNorm<1>() + radius_m(pair_.a.soup) + radius_m(pair_.b.soup);
    out_.distance_m = found.upper_m;
    out_.reached_m = pair_.tolerance_m +
                     0x1p-44 * (places + pair_.a.motion.position.lpNorm<1>() + pair_.b.motion.position.lpNorm<1>());
    out_.not_near = found.lower_m > out_.reached_m;
    if (found.upper_m == 0.0) return;
    // The nearest points move with their bodies.
    const Vec3 on_a = a.orientation * found.on_a + a.position, on_b = a.orientation * found.on_b + a.position;
    const Vec3 n = (a.orientation * Vec3(found.on_b - found.on_a)).normalized();
    const Vec3 approach = velocity_at(a, on_a) - velocity_at(b, on_b);
    const double closing = n.dot(approach), pressing = n.dot(a.acceleration - b.acceleration);
    const double unknown = 0x1p-36 + 0x1p-44 * places / found.upper_m;
    const double still = unknown * (a.velocity.norm() + b.velocity.norm() + fastest(t));
    out_.parts = closing < -still && closing * closing > 2.0 * std::max(pressing, 0.0) * pair_.tolerance_m;
    find_touch(t, closing);
  }

  void find_touch(double t, double closing) {
    const double speed = fastest(t);
    if (speed == 0.0) return;
    double before = t;
    for (double ahead = 0.01 * pair_.tolerance_m / speed; t + ahead <= pair_.step_s; ahead *= 1.25) {
      const double now = t + ahead;
      if (touch(now)) {
        bisect(t, before, now, closing);
        return;
      }
      if (distance(now, 0.1).lower_m > out_.reached_m) return;  // it passed
      before = now;
    }
  }

  void bisect(double t, double apart, double touching, double closing) {
    for (int i = 0; i < kBisections; ++i) {
      const double middle = 0.5 * (apart + touching);
      if (middle == apart || middle == touching) break;
      (touch(middle) ? touching : apart) = middle;
    }
    out_.touched = true;
    out_.early_s = touching - t;
    out_.early_m = out_.early_s * std::max(closing, 0.0);
  }

  Checker& checker_;
  const MovingPair& pair_;
  WideTree tree_a_, tree_b_;
  Judgement out_;
};

Judgement Checker::judge(const MovingPair& pair) { return Case(*this, pair).run(); }

}  // namespace peerd::bench::impact
