#include "replication/objects/updates/proximity_threshold.hpp"

#include <algorithm>
#include <cassert>
#include <optional>

#include "collision/contact/proximity.hpp"

namespace peerd::replication {
namespace {

// The search for the time within which surfaces may meet goes down to so small a part of it.
constexpr double kTimeSteps = 16.0;

// A time [s] for which two objects that may come near each other within within_s certainly don't, by halves of it:
// surfaces meet later than their bounding spheres. 0 where that is less than a part in kTimeSteps.
double apart_for_s(const collision::MovingBody& a, const collision::MovingBody& b, double within_s, double margin_m) {
  for (double s = 0.5 * within_s; s >= within_s / kTimeSteps; s *= 0.5) {
    if (!collision::may_come_near(a, b, s, margin_m)) return s;
  }
  return 0.0;
}

collision::MovingSphere sphere_of_part(const PartAt& part) {
  return {part.center_world(), part.state.velocity, part.radius_m};
}

}  // namespace

ProximityThreshold::ProximityThreshold(const PeerConfig& config, const ModelInForce& model, const Owners& owners,
                                       const Replica& replica, PeerCounters& counters)
    : config_(config), model_(model), owners_(owners), replica_(replica), counters_(counters) {}

double ProximityThreshold::usual_m(ObjectId object) const {
  return config_.policy.error_threshold_m.value_or(model_->scene->object(object).distance_threshold_m);
}

double ProximityThreshold::least_m(ObjectId object) const {
  const PublishPolicy& policy = config_.policy;
  const double tight_m = std::min(usual_m(object), policy.tight_threshold_m);
  return policy.wanted_error_m > 0.0 ? std::min(tight_m, policy.wanted_error_m) : tight_m;
}

double ProximityThreshold::at(ObjectId object, SimTime t) {
  const PublishPolicy& policy = config_.policy;
  const double usual_m = this->usual_m(object), tight_m = std::min(usual_m, policy.tight_threshold_m);
  if (!policy.track_proximity || tight_m == usual_m) return usual_m;
  const double left_s = time_to_contact_s(object, t, usual_m);
  assert(left_s >= 0.0);
  if (!(left_s < policy.close_proximity_s)) return usual_m;
  return policy.threshold_by_time ? tight_m + (usual_m - tight_m) * left_s / policy.close_proximity_s : tight_m;
}

// The time [s] until what moves with the object could meet what moves with one of another peer (Ohlenburg 2003, table
// 4.1: remote-enslaved pairs only), not more than that; at least the policy's close proximity where nothing is close.
// A policy of steps (not threshold_by_time) gets 0 where anything is close.
double ProximityThreshold::time_to_contact_s(ObjectId object, SimTime t, double threshold_m) {
  double least_s = config_.policy.close_proximity_s;
  if (model_->node(object) == nullptr) return least_s;
  std::optional<Side> mine;  // the last one: an object mostly has one part
  PartAt a;
  collision::MovingSphere sphere_a;
  for (const auto& [number, collider_is_mine] : near_pairs_of(model_->index_of(object), t)) {
    const PartPair& parts = model_->part_pairs[number];
    const CollisionPair& pair = model_->pairs[parts.pair];
    ++counters_.proximity_tests;
    const Side here{collider_is_mine ? parts.a : parts.b, collider_is_mine ? pair.collider : pair.collidee};
    const Side there{collider_is_mine ? parts.b : parts.a, collider_is_mine ? pair.collidee : pair.collider};
    if (mine != here) {
      mine = here;
      a = side_at(here, t);
      sphere_a = sphere_of_part(a);
    }
    const PartAt b = side_at(there, t);
    double left_s = collision::proximity_time_s(sphere_a, sphere_of_part(b));
    if (!(left_s < least_s)) continue;
    const bool refines = config_.policy.refine_proximity && pair.type != CollisionType::kBox;
    if (refines && a.body != nullptr && b.body != nullptr) {
      const collision::MovingBody moving_a{*a.body, a.state}, moving_b{*b.body, b.state};
      ++counters_.proximity_refined;
      if (!collision::may_come_near(moving_a, moving_b, least_s, threshold_m)) continue;
      if (config_.policy.threshold_by_time) {
        left_s = std::max(left_s, apart_for_s(moving_a, moving_b, least_s, threshold_m));
      }
    }
    if (!config_.policy.threshold_by_time || left_s == 0.0) return 0.0;
    least_s = left_s;
  }
  return least_s;
}

const std::vector<ProximityThreshold::RemotePair>& ProximityThreshold::remote_pairs_of(std::uint32_t node) {
  const std::array revisions = this->revisions();
  const auto [at, is_new] = remote_pairs_.try_emplace(node, revisions);
  RemotePairs& known = at->second;
  if (!is_new && known.revisions == revisions) return known.pairs;
  known.revisions = revisions;
  known.pairs.clear();
  for (const std::uint32_t k : model_->moved_part_pairs.listed_of(node)) {
    const PartPair& parts = model_->part_pairs[k];
    const bool collider_is_mine = model_->any_mover(parts, true, [&](std::uint32_t i) { return i == node; });
    if (is_anothers(parts, !collider_is_mine)) known.pairs.push_back({k, collider_is_mine});
  }
  return known.pairs;
}

std::array<std::uint64_t, 3> ProximityThreshold::revisions() const {
  return {owners_.revision(), replica_.received_revision(), model_.revision()};
}

const std::vector<ProximityThreshold::RemotePair>& ProximityThreshold::near_pairs_of(std::uint32_t node, SimTime t) {
  const std::vector<RemotePair>& listed = remote_pairs_of(node);
  const bool is_in_group = !model_->node_part_pairs.stretches_of(node).empty();
  if (!is_in_group) return listed;
  place_others(t);
  if (others_.nodes.empty()) return listed;
  near_pairs_ = listed;
  const auto [low, high] = way_of(node, t);
  assert(others_.index.size() <= others_.nodes.size());
  others_.index.for_each_near(low, high, [&](std::uint32_t other) {
    if (other == node) return;
    model_->for_each_part_pair_between(node, other, [&](std::uint32_t number) {
      if (model_->part_pairs.locate(number).group == nullptr) return;
      near_pairs_.push_back({number, model_->part_pairs[number].a == node});
    });
  });
  std::ranges::sort(near_pairs_, {}, &RemotePair::part_pair);
  return near_pairs_;
}

void ProximityThreshold::place_others(SimTime t) {
  const std::array now = revisions();
  const bool is_same = others_.placed_at && others_.revisions == now;
  if (is_same && *others_.placed_at == t) return;
  others_.placed_at = t;
  if (!is_same) {
    others_.revisions = now;
    others_.nodes.clear();
    others_.index = {};
    for (const PairGroup& group : model_->groups) {
      for (const PairGroup::Member& member : group.members()) {
        if (is_owned_by_another(model_->nodes[member.node].object)) others_.nodes.push_back(member.node);
      }
    }
  }
  for (const std::uint32_t node : others_.nodes) {
    const auto [low, high] = way_of(node, t);
    others_.index.set(node, low, high);
  }
}

// Two spheres that have been apart for less than half the close proximity count as close
// (collision::proximity_time_s()).
WorldBox ProximityThreshold::way_of(std::uint32_t node, SimTime t) const {
  assert(node < model_->nodes.size());
  const double close_s = config_.policy.close_proximity_s;
  const collision::MovingSphere sphere = sphere_of_part(side_at({node, model_->nodes[node].object}, t));
  const Vec3 from = sphere.center - 0.5 * close_s * sphere.velocity, to = sphere.center + close_s * sphere.velocity;
  const Vec3 reach = Vec3::Constant(sphere.radius_m + 1e-9 * (from.norm() + to.norm() + sphere.radius_m));
  return {from.cwiseMin(to) - reach, from.cwiseMax(to) + reach};
}

bool ProximityThreshold::is_owned_by_another(ObjectId object) const {
  const PeerId owner = owners_.of(object);
  return owner != kNobody && owner != config_.id && replica_.receives(object);
}

// Whether another peer, whose objects are received, owns that end of a pair, or moves that side of it relative to the
// other one.
bool ProximityThreshold::is_anothers(const PartPair& parts, bool collider) const {
  const ObjectId end = collider ? model_->pairs[parts.pair].collider : model_->pairs[parts.pair].collidee;
  if (is_owned_by_another(end)) return true;
  return replica_.receives(end) && model_->any_mover(parts, collider, [&](std::uint32_t i) {
    return is_owned_by_another(model_->nodes[i].object);
  });
}

// A part; or a sphere around the world box of all parts of a whole end, as large as these can make it in the time that
// counts as close, each going on as it does.
PartAt ProximityThreshold::side_at(const Side& side, SimTime t) const {
  const double close_s = config_.policy.close_proximity_s;
  if (side.part != ModelNode::kNone) {
    return part_at(*model_, replica_.truth(), replica_.flexible(), side.part, t, close_s);
  }
  PartAt all;
  all.state = replica_.truth().at(side.end, t);
  WorldBox box;
  double faster_m_s = 0.0;
  for (const std::uint32_t each : model_->parts_of_node[model_->index_of(side.end)]) {
    const PartAt at = part_at(*model_, replica_.truth(), replica_.flexible(), each, t, close_s);
    box.merge(at.box());
    faster_m_s = std::max(faster_m_s, (at.state.velocity - all.state.velocity).norm());
  }
  all.center = all.state.orientation.conjugate() * (0.5 * (box.lo + box.hi) - all.state.position);
  all.radius_m = 0.5 * (box.hi - box.lo).norm() + faster_m_s * close_s;
  return all;
}

}  // namespace peerd::replication
