#include "peerd/lab/live/contact_meter.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "collision/contact/box_contact.hpp"
#include "peerd/lab/live/crossing.hpp"

namespace peerd {
namespace {

// An object that goes no farther than this in the last second does not move.
constexpr double kStill_m = 0.002;

double longest_tick_s(const config::RunSettings& run) {
  std::uint32_t least_hz = run.replication.tick_hz;
  for (const config::PeerSettings& peer : run.peers) least_hz = std::min(least_hz, peer.tick_hz.value_or(least_hz));
  return 1.0 / least_hz;
}

bool is_near(const Vec3& center, double radius, const WorldBox& box) {
  double square = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double off = std::max({0.0, box.lo[k] - center[k], center[k] - box.hi[k]});
    square += off * off;
  }
  return square <= radius * radius;
}

}  // namespace

ContactMeter::ContactMeter(const config::RunSettings& run, const SharedWorld& shared,
                           std::span<const config::PeerObjects> resolved)
    : scene_(shared.world.scene), delay_s_(config::longest_delay_s(run) + longest_tick_s(run)) {
  measured_.is_driven = !shared.model->moving.empty() || std::ranges::any_of(run.events, [](const auto& e) {
    return e.kind == config::EventKind::kKey || e.kind == config::EventKind::kEdit;
  });
  for (std::size_t p = 0; p < run.peers.size(); ++p) {
    const config::PeerObjects& of = resolved[p];
    const PeerId peer{run.peers[p].id};
    names_[peer] = run.peers[p].name;
    measured_.is_driven |= !run.peers[p].keys.empty() || !run.peers[p].edits.empty();
    std::set<ObjectId> owned(of.owned.begin(), of.owned.end()), outside;
    owned.insert(of.owned_by_founder.begin(), of.owned_by_founder.end());
    for (const auto& [name, id] : of.outside) outside.insert(id);
    const std::uint64_t bodies_before = measured_.bodies;
    for (const ObjectId id : owned) {
      Object& object = objects_.emplace_back();
      object.id = id;
      object.owner = peer;
      object.threshold_m = run.replication.policy.error_threshold_m.value_or(scene_.object(id).distance_threshold_m);
      object.is_driven = of.motions.contains(id) || outside.contains(id);
      const CollisionResponse* const response = shared.model->response_of(id);
      const auto launch = of.launches.find(id);
      if (object.is_driven || response == nullptr || response->type != ResponseType::kImpulse) {
        // It puts energy into what it meets, if it moves, and its own is not known.
        measured_.is_driven |=
            object.is_driven || launch != of.launches.end() || !scene_.object(id).velocity.isZero(0.0);
        continue;
      }
      object.mass_kg = response->mass_kg;
      ++measured_.bodies;
      if (launch == of.launches.end()) continue;
      object.drive = launch->second.acceleration;
      measured_.is_driven |= launch->second.after > Duration{0};
    }
    if (measured_.bodies > bodies_before) ++measured_.owners;
  }
  std::ranges::sort(objects_, {}, &Object::id);
  for (std::uint32_t i = 0; i < objects_.size(); ++i) index_of_[objects_[i].id] = i;
  find_pairs(*shared.model);
}

void ContactMeter::find_pairs(const replication::WorldModel& model) {
  const auto object_of = [&](ObjectId id) -> Object* {
    const auto found = index_of_.find(id);
    return found == index_of_.end() ? nullptr : &objects_[found->second];
  };
  const auto is_moved = [&](const replication::ModelNode& node) {
    return index_of_.contains(node.object) || std::ranges::find(model.moving, node.object) != model.moving.end();
  };
  const auto goes_with_others = [&](const replication::ModelNode& node) {
    for (std::uint32_t i = node.carrier; i != replication::ModelNode::kNone; i = model.nodes[i].carrier) {
      if (is_moved(model.nodes[i])) return true;
    }
    return false;
  };
  std::map<ObjectId, std::uint32_t> standing;
  for (const replication::CollisionPair& pair : model.pairs) {
    Object *const a = object_of(pair.collider), *const b = object_of(pair.collidee);
    const auto answers = [&](const Object* object) {
      return object != nullptr && !object->is_driven && model.answers(pair, object->id);
    };
    if (!answers(a) && !answers(b)) continue;
    const auto is_measured = [&](ObjectId id, const Object* object) {
      const std::uint32_t node = model.index_of(id);
      const std::vector<std::uint32_t>& parts = model.parts_of_node[node];
      if (parts.size() != 1 || parts.front() != node) return false;
      return object != nullptr || (!is_moved(model.nodes[node]) && !goes_with_others(model.nodes[node]));
    };
    const collision::Body &body_a = *model.body(pair.collider), &body_b = *model.body(pair.collidee);
    if (!is_measured(pair.collider, a) || !is_measured(pair.collidee, b) ||
        (pair.type != CollisionType::kBox && !collision::has_exact_answer(body_a, body_b))) {
      ++measured_.pairs_not_measured;
      continue;
    }
    if (a != nullptr) a->body = &body_a;
    if (b != nullptr) b->body = &body_b;
    const auto add = [&](Object& from, const Object* to, ObjectId other, const collision::Body& body) {
      if (to != nullptr) {
        from.candidates.push_back({static_cast<std::uint32_t>(to - objects_.data()), false, pair.type});
        return;
      }
      const auto [known, is_new] = standing.try_emplace(other, static_cast<std::uint32_t>(standing_.size()));
      if (is_new) {
        const KinematicState state = at_rest(scene_.rigid_pose(other));
        standing_.push_back({&body, state, collision::tight_box({body, state}), scene_.path_of(other)});
      }
      from.candidates.push_back({known->second, true, pair.type});
    };
    if (a != nullptr) add(*a, b, pair.collidee, body_b);
    if (b != nullptr) add(*b, a, pair.collider, body_a);
  }
}

void ContactMeter::place(View& view, std::span<const Seen> seen) {
  view.places.resize(objects_.size());
  ++view.instant;
  std::size_t index = 0;  // most of what is seen comes in the order of the objects
  for (const Seen& s : seen) {
    if (index == objects_.size() || s.object < objects_[index].id) index = 0;
    while (index < objects_.size() && objects_[index].id < s.object) ++index;
    if (index == objects_.size() || objects_[index].id != s.object) continue;
    const Object& object = objects_[index];
    Place& place = view.places[index];
    const bool was_there = place.seen != 0;
    const bool stands = was_there && place.state.position == s.state.position &&
                        place.state.orientation.coeffs() == s.state.orientation.coeffs();
    place.velocity_before = was_there ? place.state.velocity : s.state.velocity;
    place.state = s.state;
    place.is_own = s.is_own;
    place.seen = view.instant;
    if (stands || object.body == nullptr) continue;
    place.moved = view.instant;
    place.center = s.state.pose() * object.body->center;
  }
}

void ContactMeter::see_truth(double t_s, std::span<const Seen> seen) {
  ++measured_.samples;
  place(truth_, seen);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    Object& object = objects_[i];
    const Place& place = truth_.places[i];
    if (place.seen != truth_.instant) continue;
    const Vec3& at = place.state.position;
    if (object.was_seen && (at - object.stands_at).squaredNorm() <= kStill_m * kStill_m) continue;
    if (!object.was_seen) object.first_place = at;
    object.was_seen = true;
    object.stands_at = at;
    object.stands_since_s = t_s;
  }
  find_overlaps(t_s, truth_, std::nullopt);
  add_energy();
}

void ContactMeter::see_view(double t_s, PeerId observer, std::span<const Seen> seen) {
  ++measured_.view_samples;
  View& view = views_[observer];
  place(view, seen);
  find_overlaps(t_s, view, observer);
}

void ContactMeter::find_overlaps(double t_s, const View& view, std::optional<PeerId> observer) {
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    const Object& object = objects_[i];
    const Place& place = view.places[i];
    if (object.candidates.empty() || place.seen != view.instant || place.moved != view.instant) continue;
    const double radius = object.body->radius_m;
    for (const Candidate& other : object.candidates) {
      if (other.stands) {
        if (observer && place.is_own) continue;
        const Standing& wall = standing_[other.index];
        if (!is_near(place.center, radius, wall.box)) continue;
        note(t_s, {object, *object.body, place.state, place.velocity_before},
             {object, *wall.body, wall.state, wall.state.velocity, &wall.path}, other.type, observer);
        continue;
      }
      const Place& at = view.places[other.index];
      if (at.seen != view.instant || (at.moved == view.instant && other.index < i)) continue;
      if (observer && place.is_own && at.is_own) continue;
      const Object& met = objects_[other.index];
      const double reach = radius + met.body->radius_m;
      if ((place.center - at.center).squaredNorm() > reach * reach) continue;
      note(t_s, {object, *object.body, place.state, place.velocity_before},
           {met, *met.body, at.state, at.velocity_before}, other.type, observer);
    }
  }
}

void ContactMeter::note(double t_s, const End& a, const End& b, CollisionType type, std::optional<PeerId> observer) {
  const auto [depth_m, is_lower_bound] = crossing({a.body, a.state}, {b.body, b.state}, type);
  if (depth_m <= 0.0) return;
  const auto path = [&](const End& end) { return end.path != nullptr ? *end.path : scene_.path_of(end.object.id); };
  const auto take = [&](measure::WorstPair& worst, double explained_m) {
    if (depth_m - explained_m <= worst.depth_m - worst.explained_m) return false;
    worst = {depth_m, path(a), path(b), t_s, explained_m};
    return true;
  };
  if (observer) {
    if (is_lower_bound) {
      take(measured_.view_meshes, 0.0);
    } else if (take(measured_.views, 0.0)) {
      measured_.observer = names_[*observer];
    }
    return;
  }
  take(is_lower_bound ? measured_.truth_meshes : measured_.truth, 0.0);
  double explained_m = 0.0;
  if (b.path == nullptr && a.object.owner != b.object.owner) {
    const double speed =
        std::max((a.state.velocity - b.state.velocity).norm(), (a.velocity_before - b.velocity_before).norm());
    explained_m = std::max(a.object.threshold_m, b.object.threshold_m) + speed * delay_s_;
  }
  take(measured_.unexplained, explained_m);
}

void ContactMeter::add_energy() {
  double kinetic = 0.0, potential = 0.0;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const Object& object = objects_[i];
    if (object.mass_kg == 0.0) continue;
    const Place& place = truth_.places[i];
    if (place.seen != truth_.instant) return;  // not all of them are known at this instant
    kinetic += 0.5 * object.mass_kg * place.state.velocity.squaredNorm();
    potential -= object.mass_kg * object.drive.dot(place.state.position - object.first_place);
  }
  measured_.kinetic.add(kinetic, measured_.energy_samples == 0);
  measured_.potential.add(potential, measured_.energy_samples == 0);
  measured_.sum.add(kinetic + potential, measured_.energy_samples == 0);
  ++measured_.energy_samples;
}

measure::ContactsMeasured ContactMeter::result(std::span<const measure::ContactRow> contacts, double duration_s) const {
  measure::ContactsMeasured result = measured_;
  const double last_s = duration_s - 1.0;
  std::set<std::tuple<double, ObjectId, ObjectId>> known;
  for (const measure::ContactRow& row : contacts) {
    if (row.t_s <= last_s || !measure::is_outcome(row)) continue;
    const auto stands = [&](ObjectId id) {
      const auto found = index_of_.find(id);
      return found == index_of_.end() || objects_[found->second].stands_since_s <= last_s;
    };
    if (!stands(row.collider) || !stands(row.collidee)) continue;
    known.emplace(row.t_s, std::min(row.collider, row.collidee), std::max(row.collider, row.collidee));
  }
  result.at_rest = known.size();
  return result;
}

}  // namespace peerd
