#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "collision/contact/contact_polygon.hpp"
#include "collision/contact/convex_contact.hpp"
#include "collision/exact/quadratic.hpp"

// The collidee's and the mirrored collider's Minkowski sum is a convex polytope in which the collider's origin, seen
// from the collidee's, moves along a parabola. Every facet of it gives one gap (the signed distance in front of that
// facet's plane), and the two touch or overlap while all gaps are <= 0. The facets' normals are among the separating
// axes.
namespace peerd::collision {
namespace {

// The state of a gap at time 0, by the rule of touching of first_contact().
enum class Start : std::uint8_t { kApart, kParting, kApproaching, kPressed, kStill, kInside };

struct Gap {
  Vec3 n;  // world, unit, from the collidee towards the collider
  AxisKind kind;
  Quadratic q;      // [m], exactly 0 at 0 where it touches there
  TimeSet overlap;  // where q <= 0, less the touch at 0 that it parts from
  Start start;      // at time 0
};

Start touching_start(Quadratic& q, const RoundingBound& e) {
  q.c0 = 0.0;
  if (std::abs(q.c1) <= e.speed_m_s) q.c1 = 0.0;
  if (std::abs(q.c2) <= e.half_acceleration) q.c2 = 0.0;
  if (q.c1 > 0.0) {
    // The gap is 0 again at c1/|c2|, after rising c1^2 / 4|c2|.
    const bool too_low = q.c2 < 0.0 && (q.c1 * q.c1 <= -4.0 * q.c2 * e.gap_m || q.c1 <= -q.c2 * kClockTick_s);
    if (!too_low) return Start::kParting;
    q.c1 = 0.0;
    return Start::kPressed;
  }
  if (q.c1 < 0.0) return Start::kApproaching;
  return q.c2 > 0.0 ? Start::kParting : q.c2 < 0.0 ? Start::kPressed : Start::kStill;
}

bool touches(const Quadratic& q, const RoundingBound& e) {
  return q.c0 <= e.gap_m && q.c0 >= -(e.gap_m + kClockTick_s * std::abs(q.c1));
}

// The times at which q <= 0, but each interval lasts until q exceeds its rounding bound. Two parallel flat polygons
// touch for one instant only, and a facet of their sum may be thinner than the rounding of its neighbours' times: with
// sharp ends they would slip through each other.
TimeSet overlap_of(const Quadratic& q, double horizon, const RoundingBound& e) {
  const TimeSet sharp = non_positive(q);
  const auto late = [&](double end) { return Quadratic{q.c0 - e.at(std::clamp(end, 0.0, horizon)), q.c1, q.c2}; };
  if (q.c2 > 0.0) {
    const double nearest = -0.5 * q.c1 / q.c2;
    const bool meets = sharp.first.begin <= sharp.first.end;
    const TimeSet wide = non_positive(late(meets ? sharp.first.end : nearest));
    if (wide.first.begin > wide.first.end) return sharp;
    return {{meets ? sharp.first.begin : nearest, wide.first.end}, {}};  // grazing to rounding is touching
  }
  if (sharp.first.begin > sharp.first.end || sharp.first.end == kNever) return sharp;
  const TimeSet wide = non_positive(late(sharp.first.end));
  return {{sharp.first.begin, wide.first.end}, sharp.second};
}

// Classifies the gap and finds where it overlaps, snapping what lies within its rounding bound.
Gap make_gap(const Vec3& n, AxisKind kind, const Quadratic& q, double horizon, const RoundingBound& e) {
  Gap gap{n, kind, q, {}, q.c0 > 0.0 ? Start::kApart : Start::kInside};
  if (touches(q, e)) gap.start = touching_start(gap.q, e);
  if (gap.start == Start::kParting) {
    if (gap.q.c2 < 0.0) gap.overlap.first = {-gap.q.c1 / gap.q.c2, kNever};
  } else {
    gap.overlap = overlap_of(gap.q, horizon, e);
  }
  return gap;
}

// A cheap and certain test that the gap is inside from time 0 until the horizon.
bool always_inside(const Quadratic& q, double horizon, const RoundingBound& e) {
  const double highest = q.c0 + horizon * (std::max(q.c1, 0.0) + horizon * std::max(q.c2, 0.0));
  return highest < -(e.gap_m + kClockTick_s * std::abs(q.c1));
}

// The earliest time >= t at which no gap is open. Each gap has at most two intervals, so t advances at most twice a
// gap.
double next_common(const std::vector<Gap>& gaps, double t, double horizon) {
  assert(!gaps.empty() && t >= 0.0);
  std::size_t agreeing = 0;
  for (std::size_t i = 0; agreeing < gaps.size(); i = i + 1 < gaps.size() ? i + 1 : 0) {
    const double next = gaps[i].overlap.next(t);
    if (!(next <= horizon)) return kNever;
    agreeing = next > t ? 1 : agreeing + 1;
    t = next;
  }
  return t;
}

// For two flat polygons in one plane that touch and stay: the first contact after they came apart and closed again on
// the same axis.
double next_after_parting(const std::vector<Gap>& gaps, double horizon) {
  assert(!gaps.empty());
  double parting = kNever, back = kNever;
  for (const Gap& gap : gaps) {
    const double end = gap.overlap.first.end >= 0.0 ? gap.overlap.first.end : gap.overlap.second.end;
    if (end < parting) {
      parting = end;
      back = gap.overlap.first.end >= 0.0 ? gap.overlap.second.begin : kNever;
    }
  }
  return back <= horizon ? next_common(gaps, back, horizon) : kNever;
}

// Chooses among the gaps that close at a contact: the one of the collidee's lowest polygon, else the first in the order
// of the axes.
class Closing {
 public:
  Closing(const Solid& collidee, const Mat3& R) : collidee_(collidee), R_(R) {}

  void offer(const Gap& gap) {
    const std::int64_t face = face_along(collidee_, R_, gap.n);
    if (best_ != nullptr && (face < 0 || (best_face_ >= 0 && best_face_ <= face))) return;
    best_ = &gap;
    best_face_ = face;
  }
  [[nodiscard]] const Gap* best() const { return best_; }

 private:
  const Solid& collidee_;
  const Mat3& R_;
  const Gap* best_ = nullptr;
  std::int64_t best_face_ = -1;
};

const Gap& closing_gap(const std::vector<Gap>& gaps, const PairQuery& query, const Mat3& R, double t,
                       const RoundingBound& e) {
  Closing closing(query.collidee, R), binding(query.collidee, R);
  const double still = e.speed_m_s + 2.0 * t * e.half_acceleration;
  for (const Gap& gap : gaps) {
    if (std::abs(gap.q.at(t)) <= e.at(t) && gap.q.rate(t) < -still) closing.offer(gap);
    if (gap.overlap.first.begin == t || gap.overlap.second.begin == t) binding.offer(gap);
  }
  const Gap* const chosen = closing.best() != nullptr ? closing.best() : binding.best();
  assert(chosen != nullptr);
  return *chosen;
}

const Gap& starting_gap(const std::vector<Gap>& gaps, const PairQuery& query, const Mat3& R, Start start) {
  Closing closing(query.collidee, R);
  for (const Gap& gap : gaps) {
    if (gap.start == start) closing.offer(gap);
  }
  assert(closing.best() != nullptr);
  return *closing.best();
}

}  // namespace

Contact translational_contact(const PairQuery& query, double radius_sum_m, const Mat3& R_a, const Mat3& R_b) {
  const KinematicState &a = query.collider_motion, &b = query.collidee_motion;
  const double horizon = query.horizon_s;
  const Vec3 p = a.position - b.position, v = a.velocity - b.velocity;
  const Vec3 half_acceleration = 0.5 * (a.acceleration - b.acceleration);
  assert(horizon >= 0.0 && std::isfinite(horizon));
  const RoundingBound e = rounding_bound(query, radius_sum_m);

  // This list is kept between calls for its memory alone; each call clears it.
  static thread_local std::vector<Gap> gaps;
  gaps.clear();
  bool never = false, glides = false;
  std::array<std::size_t, 6> counts{};  // by Start
  const auto any = [&](Start start) { return counts[static_cast<std::size_t>(start)] > 0; };
  double least_depth = -kNever;
  Vec3 n_least = Vec3::Zero();
  const auto consider = [&](const Vec3& n, AxisKind kind, const Quadratic& q) {
    if (q.c0 > least_depth) {
      least_depth = q.c0;
      n_least = n;
    }
    if (always_inside(q, horizon, e)) return Start::kInside;
    const Gap gap = make_gap(n, kind, q, horizon, e);
    ++counts[static_cast<std::size_t>(gap.start)];
    never = (gap.start == Start::kApart || gap.start == Start::kParting) && !(gap.overlap.next(0.0) <= horizon);
    gaps.push_back(gap);
    return gap.start;
  };
  for_each_axis(query.collider, R_a, query.collidee, R_b, [&](const Vec3& n, AxisKind kind) {
    const Extent extent_a = extent_along(rotate_back(R_a, n), query.collider.vertices);
    const Extent extent_b = extent_along(rotate_back(R_b, n), query.collidee.vertices);
    const Quadratic along{dot(n, p), dot(n, v), dot(n, half_acceleration)};
    const double high = extent_b.high - extent_a.low, low = extent_b.low - extent_a.high;
    Quadratic before{along.c0 - high, along.c1, along.c2}, behind{low - along.c0, -along.c1, -along.c2};
    // A touch is snapped to 0; the far side moves along, so that what is flat stays flat.
    if (touches(before, e)) {
      behind.c0 = low - high;
    } else if (touches(behind, e)) {
      before.c0 = low - high;
    }
    const Start in_front = consider(n, kind, before);
    const Start at_back = never ? Start::kInside : consider(-n, kind, behind);
    const bool is_flat = touches(before, e) && touches(behind, e);
    glides = glides || (!is_flat && (in_front == Start::kStill || at_back == Start::kStill));
    return !never;
  });
  if (never || glides) return {};
  const bool apart = any(Start::kApart) || any(Start::kParting);

  Contact contact;
  const auto finish = [&](ContactState state, double t, const Vec3& n) {
    assert(t >= 0.0 && t <= horizon);
    contact.state = state;
    contact.time_s = t;
    set_contact_polygon(contact, query.collidee, R_b, n, v + (2.0 * t) * half_acceleration, e.at(t));
    return contact;
  };
  if (!apart && (any(Start::kApproaching) || any(Start::kPressed))) {
    const Start start = any(Start::kApproaching) ? Start::kApproaching : Start::kPressed;
    contact.resting = start == Start::kPressed;
    return finish(ContactState::kContact, 0.0, starting_gap(gaps, query, R_b, start).n);
  }
  if (!apart && !any(Start::kStill)) {
    finish(ContactState::kOverlapped, 0.0, n_least);
    contact.normal_world = contact.separating_normal_world = n_least;
    return contact;
  }
  const double t = apart ? next_common(gaps, 0.0, horizon) : next_after_parting(gaps, horizon);
  if (!(t <= horizon)) return {};
  return finish(ContactState::kContact, t, closing_gap(gaps, query, R_b, t, e).n);
}

}  // namespace peerd::collision
