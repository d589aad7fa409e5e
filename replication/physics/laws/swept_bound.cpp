#include "replication/physics/laws/swept_bound.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "collision/contact/contact_time.hpp"

namespace peerd::replication {
namespace {

// The margin, as a fraction of all lengths involved; the rounding of a path and of the tests of the search is below
// 2^-39 of them.
constexpr double kMargin = 0x1p-30;

bool turns(const KinematicState& s) { return !s.angular_velocity_body.isZero(0.0); }

// The radius of a sphere around the body's centre that contains all vertices, and the exact sphere where the body is
// one.
double radius_of(const collision::Body& body) {
  if (!body.sphere) return body.radius_m;
  return std::max(body.radius_m, (body.sphere->center - body.center).norm() + body.sphere->radius_m);
}

// Makes the bound hold the body while it goes on for h [s] as it does at the begin.
void hold(SweptBound& bound, const collision::Body& body, const KinematicState& at_begin, bool turning, double h) {
  const double radius = radius_of(body);
  const Vec3 center = turning ? at_begin.position : Vec3(at_begin.pose() * body.center);
  const double reach = turning ? body.center.norm() + radius : radius;
  const Vec3 way = h * at_begin.velocity;
  // A tangent to the path, at any instant of it, leaves the box of the chord by no more than this, the error of the
  // tangent included.
  const double bend = 0.5 * h * h * at_begin.acceleration.norm();
  const double lengths = center.norm() + body.center.norm() + way.norm() + bend + reach;
  const double more = bend + kMargin * lengths + 4.0 * collision::kAdvancementTolerance_m;
  bound.low = bound.low.cwiseMin(center.cwiseMin(center + way) - Vec3::Constant(more));
  bound.high = bound.high.cwiseMax(center.cwiseMax(center + way) + Vec3::Constant(more));
  bound.radius_m = std::max(bound.radius_m, reach);
}

// How far a body that goes by the piece of its law in force at s is off the law's closed form.
double piece_error_m(const Timeline::Segment& law, const collision::Body& body, SimTime s) {
  if (s < law.from || is_one_piece(law.model)) return 0.0;
  const Duration begin = piece_begin(law.model, s - law.from);
  const auto end = piece_end(law.model, s - law.from);
  if (!end) return 0.0;  // the law is over
  const double h_s = to_seconds(*end - begin);
  return error_of_piece_m(bounds_within(law.model, to_seconds(begin), h_s), body.extent_m(), h_s);
}

}  // namespace

double radius_about_origin_m(const collision::Body& body) {
  double extent_m = body.extent_m();
  if (body.sphere) extent_m = std::max(extent_m, body.sphere->center.norm() + body.sphere->radius_m);
  return kBoxReach * extent_m;
}

SweptRegion standing_region(const collision::Body& body, const Vec3& position) {
  const double radius_m = radius_of(body), off_m = body.center.norm();
  const double lengths = position.norm() + 2.0 * off_m + radius_m;
  const Vec3 more = Vec3::Constant(off_m + 2.0 * (kMargin * lengths + 4.0 * collision::kAdvancementTolerance_m));
  return {position - more, position + more, radius_m};
}

SweptBound swept_bound(const Timeline& timeline, const collision::Body& body, SimTime s, SimTime begin, SimTime end) {
  assert(begin <= s && s < end);
  SweptBound bound;
  bound.last_change = timeline.last_change_until(s);
  bound.next_change = timeline.next_change_after(s);
  bound.still = is_motionless(timeline.at(s));
  if (bound.last_change) begin = std::max(begin, *bound.last_change);
  if (bound.next_change) end = std::min(end, *bound.next_change);
  // Until the instant at which a law begins, at() gives the law's own derivatives; after it the derivatives of the
  // piece.
  const SimTime law_begins = timeline.segment_at(s).from;
  bound.from = s <= law_begins ? s : std::max(begin, law_begins + Duration{1});
  bound.until = s <= law_begins ? s + Duration{1} : end;
  assert(bound.answers_for(s));

  const double h = to_seconds(end - begin);
  bound.low.setConstant(std::numeric_limits<double>::infinity());
  bound.high = -bound.low;
  const KinematicState first = timeline.at(begin);
  const double error_m = piece_error_m(timeline.segment_at(s), body, s);
  if (begin > law_begins) {
    hold(bound, body, first, turns(first), h);
    bound.radius_m += 2.0 * error_m;
    return bound;
  }
  // The searches of partners may begin with the law or within its first piece.
  const KinematicState piece = timeline.at(begin + Duration{1});
  const bool turning = turns(first) || turns(piece);
  hold(bound, body, first, turning, h);
  hold(bound, body, piece, turning, h);
  bound.radius_m += 2.0 * error_m;
  return bound;
}

SweptBound swept_bound(const ComposedPiece& piece, const collision::Body& body, SimTime s, SimTime begin, SimTime end) {
  assert(begin <= s && s < end && piece.begin <= s);
  SweptBound bound;
  bound.last_change = piece.begin;
  bound.next_change = piece.end;
  bound.still = piece.still;
  begin = std::max(begin, piece.begin);
  if (piece.end) end = std::min(end, *piece.end);
  bound.from = begin;
  bound.until = end;
  bound.low.setConstant(std::numeric_limits<double>::infinity());
  bound.high = -bound.low;
  const KinematicState first = advance(piece.state, to_seconds(begin - piece.begin));
  hold(bound, body, first, turns(first), to_seconds(end - begin));
  bound.radius_m += 2.0 * piece.error_m;
  return bound;
}

SweptBound as_box(const SweptBound& bound) {
  SweptBound box = bound;
  box.low -= Vec3::Constant(kBoxReach * bound.radius_m);
  box.high += Vec3::Constant(kBoxReach * bound.radius_m);
  box.radius_m = 0.0;
  return box;
}

SweptBound merged(const SweptBound& a, const SweptBound& b) {
  assert(a.radius_m == 0.0 && b.radius_m == 0.0);
  SweptBound all = a;
  if (b.last_change) all.last_change = a.last_change ? std::max(*a.last_change, *b.last_change) : *b.last_change;
  if (b.next_change) all.next_change = a.next_change ? std::min(*a.next_change, *b.next_change) : *b.next_change;
  all.still = a.still && b.still;
  all.low = a.low.cwiseMin(b.low);
  all.high = a.high.cwiseMax(b.high);
  all.from = std::max(a.from, b.from);
  all.until = std::min(a.until, b.until);
  return all;
}

bool apart(const SweptRegion& a, const SweptRegion& b, CollisionType type) {
  const double radii_m = a.radius_m + b.radius_m;
  const double least = type == CollisionType::kBox ? kBoxReach * radii_m : radii_m;
  for (int axis = 0; axis < 3; ++axis) {
    if (a.low[axis] - b.high[axis] > least || b.low[axis] - a.high[axis] > least) return true;
  }
  return false;
}

}  // namespace peerd::replication
