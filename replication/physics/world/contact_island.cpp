#include "replication/physics/world/contact_island.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <optional>
#include <ranges>
#include <unordered_map>
#include <utility>

#include "collision/contact/contact_time.hpp"
#include "replication/physics/world/contact_answer.hpp"

namespace peerd::replication {
namespace {

// A body is trapped where the contacts of a burst are closer than this in the mean and nothing that it meets gives way:
// in a gap of 0.1 um it would bounce a million times a second.
constexpr Duration kTrappedMean = std::chrono::microseconds(100);

// The restitution of a contact of the two; none: one of them answers otherwise than by IMPULSE, or none answers.
std::optional<double> restitution_of(const WorldModel& model, const MovingObjects& objects, const WatchedPair& pair) {
  std::optional<double> least;
  for (const auto& [object, registered] :
       {std::pair{pair.collider, pair.collider_responds}, std::pair{pair.collidee, pair.collidee_responds}}) {
    if (!registered) continue;
    const CollisionResponse& response = *model.response_of(objects[object].id);
    if (response.type != ResponseType::kImpulse) return std::nullopt;
    least = std::min(least.value_or(1.0), response.restitution);
  }
  return least;
}

// An object where it is at one instant.
struct Placed {
  KinematicState state;
  Vec3 low, high;  // its box in the world
};

// The objects around an island, each placed once.
class PlacedObjects {
 public:
  PlacedObjects(const MovingObjects& objects, SimTime t) : objects_(objects), t_(t) {}

  const Placed& of(std::uint32_t object) {
    const auto [known, is_new] = placed_.try_emplace(object);
    if (!is_new) return known->second;
    Placed& placed = known->second;
    placed.state = objects_.world_at(object, t_);
    const collision::Body& body = objects_.body(object);
    const Mat3 rotation = placed.state.orientation.toRotationMatrix();
    placed.low.setConstant(std::numeric_limits<double>::infinity());
    placed.high = -placed.low;
    const auto enclose = [&](const Vec3& at, double radius_m) {
      placed.low = placed.low.cwiseMin(at - Vec3::Constant(radius_m));
      placed.high = placed.high.cwiseMax(at + Vec3::Constant(radius_m));
    };
    if (body.sphere) {
      enclose(rotation * body.sphere->center + placed.state.position, body.sphere->radius_m);
    } else {
      for (const Vec3& vertex : body.vertices()) enclose(rotation * vertex + placed.state.position, 0.0);
    }
    return placed;
  }

 private:
  const MovingObjects& objects_;
  SimTime t_;
  std::unordered_map<std::uint32_t, Placed> placed_;
};

// The plane between two that would meet within kForeseen_s, and may be kept from it: what bounces is left to meet.
std::optional<collision::PartingPlane> foreseen_plane(const WorldModel& model, const MovingObjects& objects,
                                                      const WatchedPair& pair, PlacedObjects& placed) {
  if (!pair.is_plain || pair.inside || pair.type == CollisionType::kBox) return std::nullopt;
  const Placed &a = placed.of(pair.collider), &b = placed.of(pair.collidee);
  const Vec3 velocity = a.state.velocity - b.state.velocity;
  // The island's solution may turn any of them towards the other.
  const double way_m = kForeseen_s * std::max(velocity.norm(), kRestSpeed_m_s);
  if (((a.low - b.high).cwiseMax(b.low - a.high).array() > way_m).any()) return std::nullopt;
  const std::optional<double> restitution = restitution_of(model, objects, pair);
  if (!restitution) return std::nullopt;
  const auto plane =
      collision::widest_parting({objects.body(pair.collider), a.state}, {objects.body(pair.collidee), b.state});
  if (!plane || plane->gap_m > way_m) return std::nullopt;
  const bool bounces = *restitution > 0.0 && -plane->normal_world.dot(velocity) > kCrowdRestSpeed_m_s;
  return bounces ? std::nullopt : plane;
}

}  // namespace

ContactIsland island_of(const WorldModel& model, const MovingObjects& objects, const WatchedPairs& pairs,
                        std::span<const std::uint32_t> around, SimTime t, Touching which, Quantity quantity,
                        const AnsweredAlone& foresees) {
  assert(!foresees || quantity == Quantity::kVelocity);
  ContactIsland island;
  PlacedObjects placed(objects, t);
  std::unordered_map<std::uint32_t, std::uint32_t> places;  // of the objects that give way, in the island
  const auto add = [&](std::uint32_t object, bool moves, std::uint32_t from) {
    if (moves) {
      const auto next = static_cast<std::uint32_t>(island.objects.size());
      const auto [known, is_new] = places.try_emplace(object, next);
      if (!is_new) return known->second;
    }
    const KinematicState state = objects.world_law(object, t).state;
    const CollisionResponse* const response = model.response_of(objects[object].id);
    const bool accelerated = quantity == Quantity::kAcceleration;
    island.objects.push_back(moves ? object : ContactIsland::kNone);
    island.reached_from.push_back(from);
    island.bodies.push_back({!accelerated ? state.velocity
                             : moves      ? objects.free_acceleration_of(object, t)
                                          : state.acceleration,
                             moves ? 1.0 / response->mass_kg : 0.0});
    return static_cast<std::uint32_t>(island.objects.size() - 1);
  };
  for (const std::uint32_t object : around) {
    const bool responds = model.response_of(objects[object].id) != nullptr;
    if (objects[object].will_respond(responds, t)) add(object, true, ContactIsland::kNone);
  }
  for (std::size_t next = 0; next < island.objects.size(); ++next) {
    const std::uint32_t object = island.objects[next];
    if (object == ContactIsland::kNone) continue;
    for (const std::uint32_t i : pairs.of_end(object)) {
      const WatchedPair& pair = pairs[i];
      const bool touches =
          pair.bears_at(t) || (which == Touching::kAny && met_lately(pair.touched, t, kShortestFlight));
      if (!pair.watched || (!touches && !foresees)) continue;
      const auto other = places.find(pair.collider == object ? pair.collidee : pair.collider);
      if (other != places.end() && other->second < next) continue;  // it is there, from the other end
      const bool a_moves = objects[pair.collider].will_respond(pair.collider_responds, t);
      const bool b_moves = objects[pair.collidee].will_respond(pair.collidee_responds, t);
      if (!a_moves && !b_moves) continue;
      std::optional<collision::PartingPlane> foreseen;
      if (!touches) {
        foreseen = foreseen_plane(model, objects, pair, placed);
        if (!foreseen || !foresees(objects[pair.collider].id, objects[pair.collidee].id)) continue;
        const bool is_driven = (!a_moves && !is_motionless(placed.of(pair.collider).state)) ||
                               (!b_moves && !is_motionless(placed.of(pair.collidee).state));
        if (is_driven) continue;
      }
      const std::uint32_t body_a = add(pair.collider, a_moves, object);
      const std::uint32_t body_b = add(pair.collidee, b_moves, object);
      if (foreseen) {
        island.foreseen.push_back(static_cast<std::uint32_t>(island.constraints.size()));
        island.constraints.push_back({body_a, body_b, foreseen->normal_world, -foreseen->gap_m / kForeseen_s});
        island.pairs.push_back(i);
        continue;
      }
      for (const Vec3& n : pair.normals) {
        island.constraints.push_back({body_a, body_b, n});
        island.pairs.push_back(i);
      }
    }
  }
  return island;
}

IslandParting parting_of(const ContactIsland& island, const MovingObjects& objects, const WatchedPairs& pairs,
                         SimTime t, double rounding, bool keeps_up) {
  assert(island.holds.size() == island.constraints.size() && rounding >= 0.0);
  IslandParting parting;
  const double shortest_flight_s = is_crowd(island) ? kForeseen_s : kShortestFlight_s;
  for (std::uint32_t c = 0; c < island.constraints.size(); ++c) {
    const OneSided& constraint = island.constraints[c];
    const WatchedPair& pair = pairs[island.pairs[c]];
    if (std::ranges::find(pair.normals, constraint.normal) == pair.normals.end()) continue;  // it has been released
    const Vec3 a = objects.world_law(pair.collider, t).state.velocity;
    const Vec3 b = objects.world_law(pair.collidee, t).state.velocity;
    const double speed = constraint.normal.dot(a - b);
    const bool parts = speed > std::max(kRounding * (a.norm() + b.norm()), rounding);
    // To keep up with what moves away and gives way to nothing would take energy, but not where the two meet again
    // before any later instant: their speeds have been rounded.
    const bool is_led = !keeps_up && ((island.objects[constraint.a] == ContactIsland::kNone && !a.isZero(0.0)) ||
                                      (island.objects[constraint.b] == ContactIsland::kNone && !b.isZero(0.0)));
    if (comes_to_rest(std::max(speed, 0.0), -island.holds[c], is_led ? to_seconds(Duration{1}) : shortest_flight_s)) {
      parting.pressed.push_back(c);
      parting.pressed_part = parting.pressed_part || parts;
    } else if (parts) {
      parting.released.push_back(c);
    }
  }
  return parting;
}

void hold_together(ContactIsland& velocities, const ContactIsland& accelerations,
                   std::span<const std::uint32_t> given) {
  const std::size_t count = velocities.constraints.size();
  assert(count == velocities.pairs.size());
  for (const std::uint32_t c : given) {
    for (std::size_t i = 0; i < count; ++i) {
      OneSided& constraint = velocities.constraints[i];
      const bool is_same =
          velocities.pairs[i] == accelerations.pairs[c] && constraint.normal == accelerations.constraints[c].normal;
      constraint.is_held = constraint.is_held || is_same;
    }
  }
}

void note_solved(const ContactIsland& island, const MovingObjects& objects, WatchedPairs& pairs, SimTime t) {
  double fastest = 0.0, most = 0.0;  // speed and acceleration
  for (const std::uint32_t object : island.objects) {
    if (object == ContactIsland::kNone) continue;
    fastest = std::max(fastest, objects.world_law(object, t).state.velocity.norm());
    most = std::max(most, objects.free_acceleration_of(object, t).norm());
  }
  for (const std::uint32_t i : island.pairs) {
    WatchedPair& pair = pairs[i];
    const KinematicState a = objects.world_law(pair.collider, t).state, b = objects.world_law(pair.collidee, t).state;
    const bool is_solved = std::ranges::all_of(pair.normals, [&](const Vec3& n) {
      return n.dot(a.velocity - b.velocity) >= -kSolverRounding * fastest &&
             n.dot(a.acceleration - b.acceleration) >= -kSolverRounding * most;
    });
    pair.solved = is_solved ? t : SimTime::min();
  }
}

bool bears_another(const MovingObjects& objects, const WatchedPairs& pairs, const WatchedPair& pair, SimTime t) {
  assert(pair.is_answered());
  const auto bears = [&](std::uint32_t object, bool registered) {
    return objects[object].will_respond(registered, t) &&
           std::ranges::any_of(pairs.of_end(object),
                               [&](std::uint32_t i) { return &pairs[i] != &pair && pairs[i].bears_at(t); });
  };
  return bears(pair.collider, pair.collider_responds) || bears(pair.collidee, pair.collidee_responds);
}

std::vector<StruckPair> struck_with(const WorldModel& model, const MovingObjects& objects, const WatchedPairs& pairs,
                                    const WatchedPair& pair, SimTime t) {
  assert(pair.contact && *pair.contact == t && pair.is_answered());
  const std::array around{pair.collider, pair.collidee};
  const ContactIsland island = island_of(model, objects, pairs, around, t, Touching::kBearing, Quantity::kVelocity);
  std::vector<StruckPair> struck;
  for (std::size_t c = 0; c < island.constraints.size(); ++c) {
    const WatchedPair& other = pairs[island.pairs[c]];
    const bool both_give_way = island.objects[island.constraints[c].a] != ContactIsland::kNone &&
                               island.objects[island.constraints[c].b] != ContactIsland::kNone;
    if (&other == &pair || !both_give_way || (!struck.empty() && struck.back().pair == island.pairs[c])) continue;
    const MotionModel a = objects.world_law(other.collider, t), b = objects.world_law(other.collidee, t);
    struck.push_back({island.pairs[c], {ContactAuthority::kLocal, a, b, a, b, true, true}});
  }
  return struck;
}

bool DrivenJump::is_given(std::uint32_t object) const {
  if (!driver_.spares_given) return false;
  const Timeline::Segment& law = objects_[object].timeline.segment_at(driver_.at);
  return law.from == driver_.at && !law.cause;
}

void DrivenJump::find_run_into(std::uint32_t object, const Pose& from, const Vec3& way) {
  assert(!way.isZero(0.0) && way.allFinite());
  const SimTime t = driver_.at;
  static_cast<void>(far_.make_near({&object, 1}, way.norm(), driver_.world_start, pairs_));
  for (const std::uint32_t i : pairs_.of_end(object)) {
    const WatchedPair& pair = pairs_[i];
    if (!pair.watched || !pair.is_plain || !pair.has_exact_search || pair.type == CollisionType::kBox) continue;
    if (!objects_[pair.collider].will_respond(pair.collider_responds, t) &&
        !objects_[pair.collidee].will_respond(pair.collidee_responds, t)) {
      continue;
    }
    const bool is_collider = pair.collider == object;
    const std::uint32_t other = is_collider ? pair.collidee : pair.collider;
    const auto is_same = [&](const RunInto& each) {
      return (each.object == other && each.by == object) || (each.object == object && each.by == other);
    };
    if (std::ranges::any_of(met_, is_same) || is_given(other)) continue;
    KinematicState goes = at_rest(from);
    goes.velocity = way;  // within one second
    const KinematicState stands = at_rest(objects_.world_at(other, t).pose());
    const collision::MovingBody here{objects_.body(object), goes}, there{objects_.body(other), stands};
    const collision::Contact found = is_collider ? collision::first_contact(here, there, pair.type, 1.0)
                                                 : collision::first_contact(there, here, pair.type, 1.0);
    if (found.state != collision::ContactState::kContact) continue;
    assert(found.time_s >= 0.0 && found.time_s <= 1.0);
    const Vec3 normal = is_collider ? Vec3(-found.separating_normal_world) : found.separating_normal_world;
    met_.push_back({other, object, normal, found.time_s * std::max(0.0, normal.dot(way))});
  }
}

ContactIsland DrivenJump::solved(std::span<const std::uint32_t> around, const Vec3& of_driver,
                                 std::span<const RunInto> met) const {
  const std::uint32_t driver = driver_.object;
  ContactIsland island =
      island_of(model_, objects_, pairs_, around, driver_.at, Touching::kBearing, Quantity::kVelocity);
  for (ConstrainedBody& body : island.bodies) body.value.setZero();
  for (std::size_t c = island.constraints.size(); c-- > 0;) {
    OneSided& constraint = island.constraints[c];
    const WatchedPair& pair = pairs_[island.pairs[c]];
    const bool has_given = std::ranges::any_of(std::array{pair.collider, pair.collidee}, [&](std::uint32_t object) {
      return object != driver && is_given(object);
    });
    if (has_given) {
      island.constraints.erase(island.constraints.begin() + static_cast<std::ptrdiff_t>(c));
      island.pairs.erase(island.pairs.begin() + static_cast<std::ptrdiff_t>(c));
      continue;
    }
    constraint.is_held = driver_.holds;
    for (const auto& [body, object] :
         {std::pair{constraint.a, pair.collider}, std::pair{constraint.b, pair.collidee}}) {
      if (island.objects[body] == ContactIsland::kNone && object == driver) island.bodies[body].value = of_driver;
    }
  }
  const auto body_of = [&](std::uint32_t object) {
    const auto at = std::ranges::find(island.objects, object);
    if (at != island.objects.end()) return static_cast<std::uint32_t>(at - island.objects.begin());
    island.objects.push_back(ContactIsland::kNone);
    island.reached_from.push_back(ContactIsland::kNone);
    island.bodies.push_back({object == driver ? of_driver : Vec3(Vec3::Zero()), 0.0});
    return static_cast<std::uint32_t>(island.bodies.size() - 1);
  };
  for (const RunInto& each : met) {
    const std::uint32_t a = body_of(each.object), b = body_of(each.by);
    island.constraints.push_back({a, b, each.normal, -each.free_m});
    island.pairs.push_back(ContactIsland::kNone);
  }
  assert(island.constraints.size() == island.pairs.size());
  static_cast<void>(solve(island));
  return island;
}

ContactIsland DrivenJump::places(std::vector<std::uint32_t>& around, const Vec3& way) {
  for (;;) {
    for (const RunInto& each : met_) around.push_back(each.object);
    std::ranges::sort(around);
    around.erase(std::ranges::unique(around).begin(), around.end());
    ContactIsland ways = solved(around, way, met_);
    const std::size_t known = met_.size();
    for (std::size_t i = 0; ways.is_solved && i < ways.objects.size(); ++i) {
      const std::uint32_t object = ways.objects[i];
      const Vec3& of_it = ways.bodies[i].value;
      if (object == ContactIsland::kNone || of_it.isZero(0.0)) continue;
      find_run_into(object, objects_.world_at(object, driver_.at).pose(), of_it);
    }
    if (met_.size() == known) return ways;
  }
}

bool stands_firm(const MovingObjects& objects, const WatchedPair& pair, SimTime t) {
  const bool a_gives_way = objects[pair.collider].will_respond(pair.collider_responds, t);
  if (a_gives_way == objects[pair.collidee].will_respond(pair.collidee_responds, t)) return false;
  return is_motionless(objects.world_at(a_gives_way ? pair.collidee : pair.collider, t));
}

bool is_trapped(const MovingObjects& objects, const WatchedPairs& pairs, const WatchedPair& pair, SimTime t) {
  assert(pair.burst_from <= t);
  if (t - pair.burst_from >= pair.in_burst * kTrappedMean) return false;
  const auto gives = [&](std::uint32_t i) {
    return pairs[i].both_changed && met_lately(pairs[i].touched, t, kShortestFlight);
  };
  return std::ranges::none_of(std::array{pair.collider, pair.collidee}, [&](std::uint32_t object) {
    return objects[object].is_answering() && std::ranges::any_of(pairs.of_end(object), gives);
  });
}

bool is_driven(const ContactIsland& island) {
  for (std::size_t i = 0; i < island.objects.size(); ++i) {
    if (island.objects[i] == ContactIsland::kNone && !island.bodies[i].value.isZero(0.0)) return true;
  }
  return false;
}

std::vector<std::uint32_t> solve(ContactIsland& island) {
  assert(island.objects.size() == island.bodies.size() && island.pairs.size() == island.constraints.size());
  island.holds.assign(island.constraints.size(), 0.0);
  island.is_solved = true;
  const auto hold = [&](std::uint32_t constraint, double multiplier) {
    const OneSided& c = island.constraints[constraint];
    island.holds[constraint] = multiplier * (island.bodies[c.a].inverse_mass + island.bodies[c.b].inverse_mass);
  };
  double largest = 0.0;
  for (const ConstrainedBody& body : island.bodies) largest = std::max(largest, body.value.norm());
  const auto all = change_least(island.bodies, island.constraints);
  if (all) {
    // A crowd that stands is left with the rounding of its solution.
    const auto is_rounding = [&](const ConstrainedBody& body) {
      return body.inverse_mass == 0.0 || body.value.norm() <= kSolverRounding * largest;
    };
    if (is_crowd(island) && std::ranges::all_of(island.bodies, is_rounding)) {
      for (ConstrainedBody& body : island.bodies) {
        if (body.inverse_mass > 0.0) body.value.setZero();
      }
    }
    for (std::uint32_t i = 0; i < all->size(); ++i) hold(i, (*all)[i]);
    return {};
  }
  if (!island.foreseen.empty()) {  // those have room left
    for (const std::uint32_t i : std::views::reverse(std::exchange(island.foreseen, {}))) {
      island.constraints.erase(island.constraints.begin() + i);
      island.pairs.erase(island.pairs.begin() + i);
    }
    return solve(island);
  }
  // A body that comes and gives way to nothing leaves no room. It goes through, rather than push the others through one
  // that stands.
  std::vector<std::uint32_t> through, standing;
  std::vector<OneSided> left;
  for (std::uint32_t i = 0; i < island.constraints.size(); ++i) {
    const OneSided& c = island.constraints[i];
    const auto comes = [&](std::uint32_t body) {
      return island.objects[body] == ContactIsland::kNone && !island.bodies[body].value.isZero(0.0);
    };
    if (all.error() == LeastChangeError::kNoRoom && (comes(c.a) || comes(c.b))) {
      through.push_back(island.pairs[i]);
    } else {
      standing.push_back(i);
      left.push_back(c);
    }
  }
  if (!through.empty()) {
    if (const auto multipliers = change_least(island.bodies, left)) {
      for (std::size_t i = 0; i < standing.size(); ++i) hold(standing[i], (*multipliers)[i]);
      return through;
    }
  }
  island.is_solved = false;
  for (std::size_t i = 0; i < island.bodies.size(); ++i) {  // to stand is always a solution
    if (island.objects[i] != ContactIsland::kNone) island.bodies[i].value.setZero();
  }
  return through;
}

}  // namespace peerd::replication
