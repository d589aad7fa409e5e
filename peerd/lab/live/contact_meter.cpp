#include "peerd/lab/live/contact_meter.hpp"

#include <algorithm>
#include <array>
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
    : scene_(shared.world.scene), model_(*shared.model), delay_s_(config::longest_delay_s(run) + longest_tick_s(run)) {
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
      object.drive = launch->second.acceleration.value_or(shared.model->gravity_of(id));
      measured_.is_driven |= launch->second.after > Duration{0};
    }
    if (measured_.bodies > bodies_before) ++measured_.owners;
  }
  std::ranges::sort(objects_, {}, &Object::id);
  for (std::uint32_t i = 0; i < objects_.size(); ++i) index_of_[objects_[i].id] = i;
  find_pairs();
}

const ContactMeter::Object* ContactMeter::object_of(ObjectId id) const {
  const auto found = index_of_.find(id);
  return found == index_of_.end() ? nullptr : &objects_[found->second];
}

bool ContactMeter::is_answered(const replication::CollisionPair& pair) const {
  return std::ranges::any_of(std::array{pair.collider, pair.collidee}, [&](ObjectId end) {
    const Object* const object = object_of(end);
    return object != nullptr && !object->is_driven && model_.answers(pair, end);
  });
}

bool ContactMeter::is_measured(const replication::ModelNode& node) const {
  const std::uint32_t index = model_.index_of(node.object);
  const std::vector<std::uint32_t>& parts = model_.parts_of_node[index];
  if (parts.size() != 1 || parts.front() != index) return false;
  if (index_of_.contains(node.object)) return true;
  for (std::uint32_t i = index; i != replication::ModelNode::kNone; i = model_.nodes[i].carrier) {
    const ObjectId mover = model_.nodes[i].object;
    if (index_of_.contains(mover) || std::ranges::find(model_.moving, mover) != model_.moving.end()) return false;
  }
  return true;
}

std::uint32_t ContactMeter::standing_of(ObjectId id) {
  const auto [known, is_new] = index_of_standing_.try_emplace(id, static_cast<std::uint32_t>(standing_.size()));
  if (is_new) {
    const collision::Body& body = *model_.body(id);
    const KinematicState state = at_rest(scene_.rigid_pose(id));
    standing_.push_back({id, &body, state, collision::tight_box({body, state}), scene_.path_of(id)});
  }
  return known->second;
}

void ContactMeter::find_pairs() {
  for (const replication::PairGroup& group : model_.groups) add_crowd(group);
  model_.pairs.for_each_listed([&](std::uint32_t, const replication::CollisionPair& pair) {
    if (!is_answered(pair)) return;
    const bool both = is_measured(*model_.node(pair.collider)) && is_measured(*model_.node(pair.collidee));
    const collision::Body &a = *model_.body(pair.collider), &b = *model_.body(pair.collidee);
    if (!both || (pair.type != CollisionType::kBox && !collision::has_exact_answer(a, b))) {
      ++measured_.pairs_not_measured;
      return;
    }
    for (const auto& [end, other] : {std::pair{pair.collider, pair.collidee}, {pair.collidee, pair.collider}}) {
      const auto from = index_of_.find(end), to = index_of_.find(other);
      if (from == index_of_.end()) continue;
      Object& object = objects_[from->second];
      object.body = model_.body(end);
      const bool stands = to == index_of_.end();
      object.candidates.push_back({stands ? standing_of(other) : to->second, stands, pair.type});
    }
  });
}

void ContactMeter::add_crowd(const replication::PairGroup& group) {
  Crowd& crowd = crowds_.emplace_back(Crowd{&group, {}, {}});
  for (const replication::PairGroup::Member& member : group.members()) {
    const replication::ModelNode& node = model_.nodes[member.node];
    if (const auto index = index_of_.find(node.object); index != index_of_.end()) {
      objects_[index->second].body = model_.body(node.object);
      crowd.objects.push_back(index->second);
    } else if (is_measured(node)) {
      crowd.standing.push_back(standing_of(node.object));
    } else {
      for (std::uint32_t k = 0; k < group.count_of(member); ++k) {
        if (is_answered(group.pair(group.offset_of(member, k)))) ++measured_.pairs_not_measured;
      }
    }
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
  find_overlaps_of_crowds(t_s, view, observer);
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    const Object& object = objects_[i];
    const Place& place = view.places[i];
    if (object.candidates.empty() || place.seen != view.instant || place.moved != view.instant) continue;
    for (const Candidate& other : object.candidates) {
      if (other.stands) {
        note_standing(t_s, object, place, standing_[other.index], other.type, observer);
        continue;
      }
      const Place& at = view.places[other.index];
      if (at.seen != view.instant || (at.moved == view.instant && other.index < i)) continue;
      note_met(t_s, view, i, other.index, other.type, observer);
    }
  }
}

template <class Function>
void ContactMeter::for_each_near(const Crowd& crowd, const View& view, Function function) const {
  struct Extent {
    double low, high;
    std::uint32_t index;
  };
  std::vector<Extent> extents;
  for (const std::uint32_t i : crowd.objects) {
    const Place& place = view.places[i];
    const double radius = objects_[i].body->radius_m;
    if (place.seen == view.instant) extents.push_back({place.center.x() - radius, place.center.x() + radius, i});
  }
  std::ranges::sort(extents, {}, [](const Extent& e) { return std::pair{e.low, e.index}; });
  for (std::size_t i = 0; i < extents.size(); ++i) {
    for (std::size_t k = i + 1; k < extents.size() && extents[k].low <= extents[i].high; ++k) {
      const auto [a, b] = std::minmax(extents[i].index, extents[k].index);
      const bool a_moved = view.places[a].moved == view.instant, b_moved = view.places[b].moved == view.instant;
      if (a_moved) {
        function(a, b);
      } else if (b_moved) {
        function(b, a);
      }
    }
  }
}

void ContactMeter::find_overlaps_of_crowds(double t_s, const View& view, std::optional<PeerId> observer) {
  for (const Crowd& crowd : crowds_) {
    const replication::PairGroup& group = *crowd.group;
    const auto is_pair = [&](ObjectId a, ObjectId b) {
      const auto *const of_a = group.member(model_.index_of(a)), *const of_b = group.member(model_.index_of(b));
      const auto number = group.number_of(*of_a, *of_b);
      return number && is_answered(group.pair(*number - group.first()));
    };
    for_each_near(crowd, view, [&](std::uint32_t a, std::uint32_t b) {
      const double reach = objects_[a].body->radius_m + objects_[b].body->radius_m;
      if ((view.places[a].center - view.places[b].center).squaredNorm() > reach * reach) return;
      if (is_pair(objects_[a].id, objects_[b].id)) note_met(t_s, view, a, b, group.type(), observer);
    });
    for (const std::uint32_t i : crowd.objects) {
      const Place& place = view.places[i];
      if (place.seen != view.instant || place.moved != view.instant) continue;
      for (const std::uint32_t wall : crowd.standing) {
        if (!is_near(place.center, objects_[i].body->radius_m, standing_[wall].box)) continue;
        if (!is_pair(objects_[i].id, standing_[wall].object)) continue;
        note_standing(t_s, objects_[i], place, standing_[wall], group.type(), observer);
      }
    }
  }
}

void ContactMeter::note_standing(double t_s, const Object& object, const Place& place, const Standing& wall,
                                 CollisionType type, std::optional<PeerId> observer) {
  if ((observer && place.is_own) || !is_near(place.center, object.body->radius_m, wall.box)) return;
  note(t_s, {object, *object.body, place.state, place.velocity_before},
       {object, *wall.body, wall.state, wall.state.velocity, &wall.path}, type, observer);
}

void ContactMeter::note_met(double t_s, const View& view, std::uint32_t a, std::uint32_t b, CollisionType type,
                            std::optional<PeerId> observer) {
  const Place &place = view.places[a], &at = view.places[b];
  if (observer && place.is_own && at.is_own) return;
  const Object &object = objects_[a], &met = objects_[b];
  const double reach = object.body->radius_m + met.body->radius_m;
  if ((place.center - at.center).squaredNorm() > reach * reach) return;
  note(t_s, {object, *object.body, place.state, place.velocity_before}, {met, *met.body, at.state, at.velocity_before},
       type, observer);
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
