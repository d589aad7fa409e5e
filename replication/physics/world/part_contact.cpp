#include "replication/physics/world/part_contact.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <boost/container/small_vector.hpp>

#include "collision/contact/box_contact.hpp"
#include "collision/contact/mesh_contact.hpp"
#include "core/transform.hpp"
#include "replication/physics/world/flexible_contact.hpp"
#include "replication/physics/world/tick_detection.hpp"

namespace peerd::replication {
namespace {

using collision::Contact;
using collision::ContactState;
using collision::MovingBody;

// The states of one side from an instant on, as one piece each.
struct SideStates {
  boost::container::small_vector<KinematicState, 1> states;
  double error_m = 0.0;
  SimTime end = SimTime::max();  // the pieces of composed motion end, the first of them
};

// Whether the part moves by the pieces of one law: by all that it is, or as those that answer contacts are predicted.
bool moves_by_pieces(const MovingPart& part, SimTime t, collision::MeetAs as) {
  if (part.chain.size() != 1) return false;
  if (as != collision::MeetAs::kPolygons) return true;
  const Timeline::Segment& law = part.chain.front()->segment_at(t);
  return t < law.from || is_one_piece(law.model);
}

SideStates states_of(std::span<const MovingPart> side, SimTime t, double error_max_m, collision::MeetAs as) {
  SideStates out;
  for (const MovingPart& part : side) {
    if (part.chain.empty()) {  // it stands in the frame
      out.states.emplace_back();
      continue;
    }
    if (moves_by_pieces(part, t, as)) {
      out.states.push_back(part.chain.front()->at(t));
      continue;
    }
    const ComposedPiece piece = composed_piece(part.chain, t, part.body->extent_m(), error_max_m);
    out.states.push_back(advance(piece.state, to_seconds(t - piece.begin)));
    out.error_m = std::max(out.error_m, piece.error_m);
    if (piece.end) out.end = std::min(out.end, *piece.end);
  }
  return out;
}

std::vector<MovingBody> bodies_of(std::span<const MovingPart> side, const SideStates& states) {
  std::vector<MovingBody> bodies;
  for (std::size_t i = 0; i < side.size(); ++i) bodies.push_back({*side[i].body, states.states[i]});
  return bodies;
}

Contact search(const PartQuery& query, const SideStates& a, const SideStates& b, Duration horizon) {
  const double horizon_s = to_seconds(horizon), margin_m = a.error_m + b.error_m;
  if (a.states.size() == 1 && b.states.size() == 1) {
    return collision::first_contact({*query.a.front().body, a.states.front()},
                                    {*query.b.front().body, b.states.front()}, query.type, horizon_s,
                                    {query.as, margin_m});
  }
  assert(query.type == CollisionType::kBox);
  const auto boxes_a = bodies_of(query.a, a), boxes_b = bodies_of(query.b, b);
  return collision::first_box_contact(boxes_a, boxes_b, horizon_s, margin_m);
}

// No material points of the two move faster against each other, within h_s.
double material_speed_m_s(const MovingBody& a, const MovingBody& b, double h_s) {
  const KinematicState &of_a = a.motion, &of_b = b.motion;
  return (of_a.velocity - of_b.velocity).norm() + h_s * (of_a.acceleration - of_b.acceleration).norm() +
         of_a.angular_velocity_body.norm() * a.body.extent_m() + of_b.angular_velocity_body.norm() * b.body.extent_m();
}

SimTime time_of(const Contact& found, SimTime begin) {
  return begin + Duration{static_cast<std::int64_t>(std::floor(found.time_s * 1e9))};
}

bool is_detected_at_ticks(const PartQuery& query) {
  return query.detection != nullptr && TickDetection::answers(query);
}

}  // namespace

SweptBound swept_bound_of_way(const MovingPart& part, SimTime s, SimTime end) {
  assert(s < end);
  SweptBound bound;
  MotionBounds in_node;
  FlexibleParts::Form form;
  if (part.flexible != nullptr) {
    const FlexibleParts::Course course = part.flexible->course(part.form, s, to_seconds(end - s));
    in_node = course.bounds;
    bound.next_change = course.end;
    part.flexible->form(part.form, s, form);
  } else {
    in_node.distance_m = part.body->extent_m();
    form.vertices.assign(part.body->vertices().begin(), part.body->vertices().end());
  }
  Affine place;
  if (!part.chain.empty()) {
    const auto until = smooth_until(part.chain, s);
    if (until) bound.next_change = bound.next_change ? std::min(*bound.next_change, *until) : *until;
    const KinematicState state = composed_at(part.chain, s);
    place = {state.orientation.toRotationMatrix(), state.position};
    in_node = composed_bounds(part.chain, s, to_seconds(end - s), in_node);
  }
  if (bound.next_change && *bound.next_change <= s) bound.next_change = s + Duration{1};
  if (bound.next_change) end = std::min(end, *bound.next_change);
  bound.still = in_node.speed_m_s == 0.0 && in_node.acceleration_m_s2 == 0.0 && in_node.spin_rad_s == 0.0;
  bound.low.setConstant(std::numeric_limits<double>::infinity());
  bound.high = -bound.low;
  const double way_m = to_seconds(end - s) * in_node.speed_m_s + 4.0 * collision::kAdvancementTolerance_m;
  for (const Vec3& v : form.vertices) {
    const Vec3 at = multiply(place.linear, v) + place.offset;
    bound.low = bound.low.cwiseMin(at - Vec3::Constant(way_m));
    bound.high = bound.high.cwiseMax(at + Vec3::Constant(way_m));
  }
  bound.from = s;
  bound.until = end;
  return bound;
}

PartContact first_part_contact(const PartQuery& query, SimTime begin, SimTime from, SimTime until,
                               std::uint64_t& searches) {
  assert(begin <= from && from < until && !query.a.empty() && !query.b.empty());
  if (query.is_flexible()) return first_flexible_contact(query, from, until, searches);
  if (is_detected_at_ticks(query)) return query.detection->first_contact(query, from, until, searches);
  const auto search_from = [&](SimTime t, SimTime end, const SideStates& a, const SideStates& b) {
    ++searches;
    PartContact found{search(query, a, b, end - t), t, a.states.front(), b.states.front()};
    found.at = time_of(found.contact, t);
    return found;
  };
  const auto states_at = [&](SimTime t, double error_max_m) {
    return std::pair{states_of(query.a, t, error_max_m, query.as), states_of(query.b, t, error_max_m, query.as)};
  };
  PartContact found;
  for (SimTime t = begin; t < until;) {
    const auto [a, b] = states_at(t, kCoarseError_m);
    const SimTime end = std::min({until, a.end, b.end});
    if (end <= from) {
      t = end;
      continue;
    }
    found = search_from(t, end, a, b);
    if (found.contact.state == ContactState::kUnsupported) return found;
    if (a.error_m == 0.0 && b.error_m == 0.0) {
      const bool dealt_with = found.contact.state != ContactState::kSeparated && found.at < from;
      if (t < from && dealt_with) {
        const auto [later_a, later_b] = states_at(from, kCoarseError_m);
        found = search_from(from, end, later_a, later_b);
      }
      if (found.contact.state != ContactState::kSeparated) return found;
    } else if (found.contact.state != ContactState::kSeparated) {
      for (SimTime u = std::max(found.at, from); u < end;) {
        const auto [fine_a, fine_b] = states_at(u, kFineError_m);
        const SimTime fine_end = std::min({end, fine_a.end, fine_b.end});
        found = search_from(u, fine_end, fine_a, fine_b);
        if (found.contact.state != ContactState::kSeparated) return found;
        u = fine_end;
      }
    }
    t = end;
  }
  return found;
}

bool parts_touch(const PartQuery& query, SimTime t) {
  if (query.is_flexible()) return flexible_parts_touch(query, t);
  if (is_detected_at_ticks(query)) return query.detection->touch(query, t);
  const SideStates a = states_of(query.a, t, kFineError_m, query.as), b = states_of(query.b, t, kFineError_m, query.as);
  const double margin_m = a.error_m + b.error_m;
  if (a.states.size() == 1 && b.states.size() == 1) {
    return collision::touching({*query.a.front().body, a.states.front()}, {*query.b.front().body, b.states.front()},
                               query.type, {query.as, margin_m});
  }
  const auto boxes_a = bodies_of(query.a, a), boxes_b = bodies_of(query.b, b);
  return collision::box_gap_m(boxes_a, boxes_b) <= margin_m + 2.0 * collision::kAdvancementTolerance_m;
}

SimTime parts_touch_until(const PartQuery& query, SimTime t, SimTime until) {
  assert(t < until);
  if (is_detected_at_ticks(query)) return std::min(until, query.detection->next_tick_after(t));
  double certain_s = 0.0;
  if (query.is_flexible()) {
    certain_s = flexible_parts_touch_for_s(query, t, until);
  } else {
    const SideStates a = states_of(query.a, t, kCoarseError_m, query.as),
                     b = states_of(query.b, t, kCoarseError_m, query.as);
    const auto bodies_a = bodies_of(query.a, a), bodies_b = bodies_of(query.b, b);
    const double error_m = a.error_m + b.error_m, left_s = to_seconds(std::min({until, a.end, b.end}) - t);
    if (query.type != CollisionType::kBox) {
      const double depth_m = collision::touch_depth_m(bodies_a.front(), bodies_b.front()) - 2.0 * error_m;
      const double speed_m_s = material_speed_m_s(bodies_a.front(), bodies_b.front(), left_s);
      certain_s = depth_m <= 0.0 ? 0.0 : speed_m_s * left_s < depth_m ? left_s : depth_m / speed_m_s;
    } else if (error_m == 0.0) {
      certain_s = collision::boxes_overlap_for_s(bodies_a, bodies_b, left_s);
    }
  }
  return std::min(until, t + std::max(kTouchCheck, Duration{static_cast<std::int64_t>(certain_s * 1e9)}));
}

}  // namespace peerd::replication
