#include "replication/physics/world/pair_search.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "collision/contact/mesh_contact.hpp"
#include "replication/physics/world/tick_detection.hpp"

namespace peerd::replication {
namespace {

// While two bear each other and one of them moves, whether they still touch is checked at the multiples of this.
constexpr Duration kBearingCheck{std::int64_t{1} << 24};
// Contacts that begin and end by one jump of a law are found within this time: world times are rounded to nanoseconds.
constexpr Duration kSameJump = std::chrono::microseconds(1);

}  // namespace

SweptBound PairSearch::bound_of_side(const WatchedPair& pair, bool of_collider, SimTime s) {
  const std::uint32_t part = of_collider ? pair.part_a : pair.part_b;
  if (part == MovingObjects::kNone) return objects_.bound_of_end(of_collider ? pair.collider : pair.collidee, s);
  const bool is_kept = pair.common == MovingObjects::kNone && !model_.is_flexible(part);
  return is_kept ? objects_.bound_of(part, s) : objects_.make_bound(part, pair.common, s);
}

template <class Function>
auto PairSearch::with_query(const WatchedPair& pair, Function function) const {
  // An object that nothing stopped at the surface is in contact until it has come out again.
  const auto as = !pair.is_answered() ? collision::MeetAs::kPolygons
                  : pair.inside       ? collision::MeetAs::kSolids
                                      : collision::MeetAs::kSurfaces;
  if (pair.is_plain) {  // nothing is composed
    const Timeline *const a = &objects_[pair.part_a].timeline, *const b = &objects_[pair.part_b].timeline;
    const MovingPart part_a{{&a, 1}, &objects_.body(pair.part_a)}, part_b{{&b, 1}, &objects_.body(pair.part_b)};
    return function(PartQuery{{&part_a, 1}, {&part_b, 1}, pair.type, as, detection_});
  }
  boost::container::small_vector<MovingObjects::OwnChain, 2> chains;
  boost::container::small_vector<MovingPart, 2> sides[2];
  const auto add = [&](std::size_t side, std::uint32_t part) {
    chains.push_back(objects_.chain_of(model_.frame_of(part), pair.common));
    sides[side].push_back(objects_.moving_part(part, {}));
  };
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    const std::uint32_t part = side == 0 ? pair.part_a : pair.part_b;
    if (part != MovingObjects::kNone) {
      add(side, part);
    } else {
      for (const std::uint32_t each : model_.parts_of_node[side == 0 ? pair.collider : pair.collidee]) add(side, each);
    }
  }
  std::size_t next = 0;  // the chains do not move any more
  for (auto& side : sides) {
    for (MovingPart& part : side) {
      part.chain = {chains[next].data(), chains[next].size()};
      ++next;
    }
  }
  const PartQuery query{
      {sides[0].data(), sides[0].size()}, {sides[1].data(), sides[1].size()}, pair.type, as, detection_};
  return function(query);
}

bool PairSearch::search_window(WatchedPair& pair) {
  const SimTime s = pair.clear_until;
  if (!pair.is_plain) return search_composed_window(pair);
  return search_window(pair, objects_.bound_of(pair.part_a, s), objects_.bound_of(pair.part_b, s));
}

bool PairSearch::search_composed_window(WatchedPair& pair) {
  const SweptBound a = bound_of_side(pair, true, pair.clear_until), b = bound_of_side(pair, false, pair.clear_until);
  return search_window(pair, a, b);
}

bool PairSearch::search_window(WatchedPair& pair, const SweptBound& bound_a, const SweptBound& bound_b) {
  const SimTime s = pair.clear_until;
  SimTime end = floor_to(s, MovingObjects::kLookahead) + MovingObjects::kLookahead;
  if (bound_a.next_change) end = std::min(end, *bound_a.next_change);
  if (bound_b.next_change) end = std::min(end, *bound_b.next_change);
  const bool still = bound_a.still && bound_b.still;
  if (pair.bears && !still) end = std::min(end, floor_to(s, kBearingCheck) + kBearingCheck);
  assert(end > s);

  if (still) {  // two objects that stand do not meet
    ++counters_.searches_skipped;
    pair.clear_until = bound_a.next_change || bound_b.next_change ? end : SimTime::max();
    return false;
  }
  if (pair.has_exact_search && apart(bound_a, bound_b, pair.type)) {
    ++counters_.searches_far;
    if (pair.bears) {
      if (s < pair.held_until) {
        pair.clear_until = std::min(pair.held_until, end);
      } else {
        pair.contact = s;
        pair.lifts = true;
      }
      return false;
    }
    note_apart(pair, s);
    pair.clear_until = end;
    return true;
  }
  if (pair.put_off && !pair.bears) {
    ++counters_.searches_put_off;
    pair.stopped = true;
    return false;
  }
  // A search begins not where this peer happens to be, but at the last instant until s that the timelines alone
  // decide, so that equal timelines give equal contact times, to the last bit.
  SimTime begin = floor_to(s, MovingObjects::kLookahead);
  if (bound_a.last_change) begin = std::max(begin, *bound_a.last_change);
  if (bound_b.last_change) begin = std::max(begin, *bound_b.last_change);
  if (glides(pair, bound_a, bound_b, s)) {
    note_apart(pair, s);
    pair.clear_until = end;
  } else {
    search_interval(pair, begin, end);
  }
  const SimTime held = std::max(s, pair.held_until);
  if (pair.bears && !pair.contact && held < pair.clear_until) search_lift(pair, held, pair.clear_until);
  return false;
}

bool PairSearch::touch_at(const WatchedPair& pair, SimTime t) const {
  return with_query(pair, [&](const PartQuery& query) { return parts_touch(query, t); });
}

std::optional<Vec3> PairSearch::normal_of_meeting(const WatchedPair& pair, SimTime t, Duration within) const {
  if (!touch_at(pair, t)) return std::nullopt;
  const PartContact found = with_query(pair, [&](const PartQuery& query) {
    return first_part_contact(query, t, t, t + within, counters_.contact_searches);
  });
  const collision::Contact& c = found.contact;
  const Vec3& normal = answers_by_impulse(pair) ? c.separating_normal_world : c.normal_world;
  const bool meet = c.state == collision::ContactState::kContact || c.state == collision::ContactState::kOverlapped;
  if (!meet) return std::nullopt;
  if (c.state == collision::ContactState::kOverlapped) {  // they part, or are pressed together
    const double speed = normal.dot(found.a.velocity - found.b.velocity);
    const double acceleration = normal.dot(found.a.acceleration - found.b.acceleration);
    if (speed >= 0.0 && !comes_to_rest(speed, acceleration, to_seconds(within))) return std::nullopt;
  }
  if (pair.common == MovingObjects::kNone) return normal;
  return Vec3(objects_.world_at(pair.common, t).orientation * normal);
}

// Whether another part of the one end touches another part of the other one: then the two ends did so before t.
bool PairSearch::ends_touch_elsewhere(const WatchedPair& pair, SimTime t) {
  assert(!pair.is_answered());
  const auto [first, end] = model_.part_pairs_of_pair(pair.number);
  for (std::uint32_t i = first; i < end; ++i) {
    WatchedPair& other = pairs_[i];
    if (&other == &pair || other.unsupported) continue;
    // A law may make an end jump, so that one part begins to touch as another ceases to.
    // The search may have gone beyond t.
    const bool has_parted = !other.inside && other.parted >= t - kSameJump;
    const SimTime before = (has_parted ? std::min(other.parted, t) : t) - Duration{1};
    const bool touched = (other.inside || !other.searched || has_parted) && touch_at(other, before);
    if (other.fixed ? fixed_parts_touch(other, t) : touched) return true;
  }
  return false;
}

bool PairSearch::fixed_parts_touch(WatchedPair& pair, SimTime t) const {
  assert(pair.fixed);
  if (pair.type == CollisionType::kBox) return touch_at(pair, t);
  if (!pair.fixed_touch) {
    const auto state = [&](std::uint32_t part) {
      const MovingObjects::OwnChain chain = objects_.chain_of(part, pair.common);
      return chain.empty() ? KinematicState{} : composed_at({chain.data(), chain.size()}, t);
    };
    const KinematicState a = state(pair.part_a), b = state(pair.part_b);
    pair.fixed_touch =
        collision::different_shapes_touch({objects_.body(pair.part_a), a}, {objects_.body(pair.part_b), b});
  }
  return *pair.fixed_touch;
}

void PairSearch::search_lift(WatchedPair& pair, SimTime begin, SimTime end) {
  assert(pair.bears && begin < end);
  if (touch_at(pair, end)) return;
  SimTime touching = begin, apart = end;
  while (apart - touching > Duration{1}) {
    const SimTime middle = touching + (apart - touching) / 2;
    (touch_at(pair, middle) ? touching : apart) = middle;
  }
  pair.contact = pair.clear_until = apart;
  pair.lifts = true;
}

void PairSearch::note_touch(WatchedPair& pair, SimTime t) const {
  const bool has_other_normals = pair.bears || met_lately(pair.touched, t, kShortestFlight);
  pair.note_touch(t, has_other_normals && is_parted_by(pair, pair.normal, t));
}

bool PairSearch::is_parted_by(const WatchedPair& pair, const Vec3& normal, SimTime t) const {
  assert(std::abs(normal.squaredNorm() - 1.0) < 1e-9);
  if (!pair.is_plain || pair.type == CollisionType::kBox) return false;
  const auto reach = [&](std::uint32_t object, const Vec3& direction) {
    const collision::Body& body = objects_.body(object);
    const KinematicState state = objects_.world_at(object, t);
    const Vec3 n = state.orientation.conjugate() * direction;
    if (body.sphere) return direction.dot(state.position) + n.dot(body.sphere->center) + body.sphere->radius_m;
    double farthest = -std::numeric_limits<double>::infinity();
    for (const Vec3& vertex : body.vertices()) farthest = std::max(farthest, n.dot(vertex));
    return direction.dot(state.position) + farthest;
  };
  return -reach(pair.collider, -normal) - reach(pair.collidee, normal) >=
         -collision::advancement_tolerance_m(objects_.body(pair.collider).radius_m,
                                             objects_.body(pair.collidee).radius_m);
}

bool PairSearch::glides(const WatchedPair& pair, const SweptBound& a, const SweptBound& b, SimTime s) const {
  const auto has_changed = [&](const SweptBound& bound) {
    return bound.last_change && *bound.last_change > pair.solved;
  };
  const auto turns = [&](std::uint32_t object) {
    const MotionModel law = objects_[object].timeline.model_at(s);
    return !law.state.angular_velocity_body.isZero(0.0) || !law.angular_acceleration_body.isZero(0.0);
  };
  if (!pair.bears || has_changed(a) || has_changed(b) || !pair.is_plain) return false;
  if (turns(pair.collider) || turns(pair.collidee) || pair.normals.size() != 1) return false;
  return is_parted_by(pair, pair.normals.front(), s);
}

// Until the base of an object that responds it went through everything: the base says where it really was.
void PairSearch::note_apart(WatchedPair& pair, SimTime s) {
  if (std::exchange(pair.inside, false)) {
    pair.parted = s;
    pair.parted_from = pair.touched;
  }
  const auto is_given_later = [&](std::size_t object, bool registered) {
    return registered && objects_[object].is_answering() && objects_[object].base_time > s;
  };
  if (is_given_later(pair.collider, pair.collider_responds)) return;
  if (is_given_later(pair.collidee, pair.collidee_responds)) return;
  pair.note_free(s);
}

// An impulse acts along the direction in which the two touch. The responses of the thesis are to the polygon that
// is met.
bool PairSearch::answers_by_impulse(const WatchedPair& pair) const {
  const auto by_impulse = [&](std::uint32_t object, bool registered) {
    return registered && model_.response_of(objects_[object].id)->type == ResponseType::kImpulse;
  };
  return by_impulse(pair.collider, pair.collider_responds) || by_impulse(pair.collidee, pair.collidee_responds);
}

// At contact times what has been answered is apart; at ticks it may be on its way out.
bool PairSearch::was_apart(const WatchedPair& pair, SimTime s) const {
  const bool is_at_ticks =
      detection_ != nullptr && with_query(pair, [](const PartQuery& query) { return TickDetection::answers(query); });
  return !is_at_ticks || !touch_at(pair, s);
}

// The last instant of a search would have been a multiple of kLookahead or a change of the laws as they were.
void PairSearch::note_was_far(WatchedPair& pair, const std::optional<NewLaw>& law, SimTime reopened) {
  assert(!pair.inside && !pair.contact);
  const SimTime until = std::min(pair.clear_until, reopened);
  SimTime last = floor_to(until - Duration{1}, MovingObjects::kLookahead);
  for (const std::uint32_t object : {pair.collider, pair.collidee}) {
    const bool is_new = law && law->object == object;
    const SimTime known = is_new ? std::min(law->from, until) : until;
    if (const auto change = objects_[object].timeline.last_change_until(known - Duration{1})) {
      last = std::max(last, *change);
    }
  }
  const auto is_given_later = [&](std::uint32_t object, bool registered) {
    const bool is_new = law && law->object == object;
    return !is_new && registered && objects_[object].is_answering() && objects_[object].base_time > last;
  };
  if (is_given_later(pair.collider, pair.collider_responds)) return;
  if (is_given_later(pair.collidee, pair.collidee_responds)) return;
  if (!pair.free_at || last > *pair.free_at) pair.note_free(last);
}

// A contact that nobody answers is one for as long as it lasts.
bool PairSearch::goes_on(WatchedPair& pair, SimTime s, SimTime end) {
  if (pair.is_answered() || !pair.inside) return false;
  if (!touch_at(pair, s)) {
    note_apart(pair, s);
    return false;
  }
  pair.clear_until = with_query(pair, [&](const PartQuery& query) { return parts_touch_until(query, s, end); });
  return true;
}

void PairSearch::search_interval(WatchedPair& pair, SimTime begin, SimTime end) {
  const MovingObject &a = objects_[pair.collider], &b = objects_[pair.collidee];
  const SimTime s = pair.clear_until;
  assert(begin <= s && s < end);
  // A contact that nobody answered because a base was given later is answered from that base on.
  const auto answers_since = [&](const MovingObject& o, bool registered) {
    return o.will_respond(registered, s) && o.base_time > pair.touched;
  };
  if (answers_since(a, pair.collider_responds) || answers_since(b, pair.collidee_responds)) pair.inside = false;
  if (goes_on(pair, s, end)) return;
  const PartContact found = with_query(pair, [&](const PartQuery& query) {
    return first_part_contact(query, begin, s, end, counters_.contact_searches);
  });
  collision::Contact c = found.contact;
  const Vec3& normal = answers_by_impulse(pair) ? c.separating_normal_world : c.normal_world;
  const KinematicState &state_a = found.a, &state_b = found.b;
  const auto contact_at = [&](SimTime t, bool overlapped) {
    assert(t >= s);
    pair.contact = t;
    pair.clear_until = t;
    pair.normal =
        pair.common == MovingObjects::kNone ? normal : Vec3(objects_.world_at(pair.common, t).orientation * normal);
    pair.overlapped = overlapped;
    pair.resting = c.resting;
    pair.lifts = false;
  };
  const bool first = !std::exchange(pair.searched, true);
  switch (c.state) {
    case collision::ContactState::kSeparated:
      if (was_apart(pair, s)) note_apart(pair, s);
      pair.clear_until = end;
      return;
    case collision::ContactState::kContact: {
      const SimTime t = found.at;
      if (t > s && was_apart(pair, s)) note_apart(pair, s);
      if (pair.inside) {
        pair.clear_until = std::min(s + kOverlapRetry, end);
      } else if (t >= end) {
        pair.clear_until = end;  // the next pieces, or the next search, begin first
      } else {
        contact_at(t, false);
      }
      return;
    }
    case collision::ContactState::kOverlapped: {
      ++counters_.overlapped;
      if (first) events_.push_back(BodiesOverlap{s, a.id, b.id});
      if (!pair.is_answered()) {
        if (s > start_) return contact_at(found.at, true);  // a law has put it there
        pair.inside = true;
        pair.clear_until = std::min(s + kTouchCheck, end);
        return;
      }
      const double speed = normal.dot(state_a.velocity - state_b.velocity);
      const bool pressed = speed == 0.0 && normal.dot(state_a.acceleration - state_b.acceleration) < 0.0;
      const bool answers = a.will_respond(pair.collider_responds, s) || b.will_respond(pair.collidee_responds, s);
      if ((speed < 0.0 || pressed) && answers && !pair.inside) {
        c.resting = pressed;
        contact_at(s, true);
      } else {
        pair.clear_until = std::min(s + kOverlapRetry, end);
      }
      return;
    }
    case collision::ContactState::kUnsupported:
      ++counters_.unsupported;
      pair.unsupported = true;
      return;
    case collision::ContactState::kFailed:
      ++counters_.failed;
      pair.clear_until = std::min(std::max(s + kOverlapRetry, found.at), end);
      return;
  }
}

std::optional<SimTime> PairSearch::search(WatchedPair& pair, SimTime to) {
  assert(pair.watched && !pair.fixed && !pair.stopped);
  if (pair.contact || pair.clear_until > to) {
    ++counters_.searches_skipped;
    return std::nullopt;
  }
  std::optional<SimTime> apart_at;
  while (!pair.contact && !pair.unsupported && !pair.stopped && pair.clear_until <= to) {
    const SimTime s = pair.clear_until;
    apart_at = search_window(pair) ? std::optional(s) : std::nullopt;
  }
  return apart_at;
}

}  // namespace peerd::replication
