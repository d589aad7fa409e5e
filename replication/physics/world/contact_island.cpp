#include "replication/physics/world/contact_island.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::replication {

ContactIsland island_of(const WorldModel& model, const MovingObjects& objects, const WatchedPairs& pairs,
                        std::span<const std::uint32_t> around, SimTime t, Touching which, Quantity quantity) {
  ContactIsland island;
  const auto add = [&](std::uint32_t object, bool moves, std::uint32_t from) {
    if (moves) {
      const auto known = std::ranges::find(island.objects, object);
      if (known != island.objects.end()) return static_cast<std::uint32_t>(known - island.objects.begin());
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
  std::vector<std::uint32_t> seen;
  for (std::size_t next = 0; next < island.objects.size(); ++next) {
    const std::uint32_t object = island.objects[next];
    if (object == ContactIsland::kNone) continue;
    for (const std::uint32_t i : model.part_pairs_of(object)) {
      const WatchedPair* const known = pairs.find(i);
      if (known == nullptr) continue;
      const WatchedPair& pair = *known;
      const bool touches =
          pair.bears_at(t) || (which == Touching::kAny && met_lately(pair.touched, t, kShortestFlight));
      if (!touches || !pair.watched || std::ranges::find(seen, i) != seen.end()) continue;
      seen.push_back(i);
      const bool a_moves = objects[pair.collider].will_respond(pair.collider_responds, t);
      const bool b_moves = objects[pair.collidee].will_respond(pair.collidee_responds, t);
      if (!a_moves && !b_moves) continue;
      const std::uint32_t body_a = add(pair.collider, a_moves, object);
      const std::uint32_t body_b = add(pair.collidee, b_moves, object);
      for (const Vec3& n : pair.normals) {
        island.constraints.push_back({body_a, body_b, n});
        island.pairs.push_back(i);
      }
    }
  }
  return island;
}

bool is_driven(const ContactIsland& island) {
  for (std::size_t i = 0; i < island.objects.size(); ++i) {
    if (island.objects[i] == ContactIsland::kNone && !island.bodies[i].value.isZero(0.0)) return true;
  }
  return false;
}

std::vector<std::uint32_t> solve(ContactIsland& island) {
  assert(island.objects.size() == island.bodies.size() && island.pairs.size() == island.constraints.size());
  if (change_least(island.bodies, island.constraints)) return {};
  // A body that comes and gives way to nothing leaves no room. It goes through, rather than push the others through one
  // that stands.
  std::vector<std::uint32_t> through;
  std::vector<OneSided> standing;
  for (std::size_t i = 0; i < island.constraints.size(); ++i) {
    const OneSided& c = island.constraints[i];
    const auto comes = [&](std::uint32_t body) {
      return island.objects[body] == ContactIsland::kNone && !island.bodies[body].value.isZero(0.0);
    };
    if (comes(c.a) || comes(c.b)) {
      through.push_back(island.pairs[i]);
    } else {
      standing.push_back(c);
    }
  }
  if (change_least(island.bodies, standing)) return through;
  for (std::size_t i = 0; i < island.bodies.size(); ++i) {  // rounding left no solution: to stand is always one
    if (island.objects[i] != ContactIsland::kNone) island.bodies[i].value.setZero();
  }
  return through;
}

}  // namespace peerd::replication
