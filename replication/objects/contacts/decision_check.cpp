#include "replication/objects/contacts/decision_check.hpp"

#include <algorithm>
#include <cassert>
#include <vector>

#include "replication/physics/parts/part_at.hpp"

namespace peerd::replication {

struct DecisionCheck::Belief {
  std::vector<Vec3> positions;
  double speed_m_s = 0.0;

  [[nodiscard]] bool is_near(const Vec3& p, double extent_m) const {
    const double farthest_m = kElsewhere_m + 2.0 * extent_m + speed_m_s * to_seconds(kKnowledgeDiffers);
    return std::ranges::any_of(positions, [&](const Vec3& q) { return (p - q).norm() <= farthest_m; });
  }
};

// The farthest point of any part of the object from its position.
double DecisionCheck::extent_m(ObjectId object) const {
  const SimTime t = ticks_.last_time();
  const Vec3 center = replica_.ghosts().at(object, t).position;
  double farthest_m = 0.0;
  for (const std::uint32_t part : model_->parts_of_node[model_->index_of(object)]) {
    const PartAt each = part_at(*model_, replica_.ghosts(), replica_.flexible(), part, t);
    farthest_m = std::max(farthest_m, (each.state.position - center).norm() + each.extent_m);
  }
  return farthest_m;
}

// An object that something drives may have been put elsewhere a moment ago: the decider may not know that yet.
DecisionCheck::Belief DecisionCheck::belief(ObjectId object, SimTime contact) const {
  Belief belief;
  const MotionWorld& ghosts = replica_.ghosts();
  const SimTime last = ticks_.last_time();
  const SimTime around = std::min(contact, last);
  for (const SimTime t : {last, around, around - std::chrono::seconds(1), around - std::chrono::seconds(2)}) {
    if (!ghosts.has_history_at(object, t)) continue;
    const KinematicState state = ghosts.at(object, t);
    belief.positions.push_back(state.position);
    belief.speed_m_s = std::max(belief.speed_m_s, state.velocity.norm());
  }
  return belief;
}

bool DecisionCheck::knows(HostTime now, ObjectId object) const {
  if (!replica_.receives(object) || !replica_.ghosts().has(object)) return false;
  if (ticks_.last_time() - replica_.begun_at() < kSettling) return false;
  const auto owner = members_.all().find(owners_.of(object));
  if (owner == members_.all().end()) return true;  // this peer's own, or nobody's
  return now - owner->second.since >= kSettling && replica_.last_update_of(object) != nullptr;
}

std::optional<MemberLimit> DecisionCheck::broken_by(HostTime now, PeerId sender, const DecisionRecord& d) const {
  assert(model_->are_paired(d.collider, d.collidee));
  if (!knows(now, d.collider) || !knows(now, d.collidee)) return std::nullopt;
  for (const ObjectId object : {d.collider, d.collidee}) replica_.compute_ghost(object);
  const double collider_m = extent_m(d.collider), collidee_m = extent_m(d.collidee);
  const double apart_m = (d.collider_before.position - d.collidee_before.position).norm();
  if (apart_m > kApart_m + 2.0 * (collider_m + collidee_m)) return MemberLimit::kDecisionImpossible;
  const Belief collider = belief(d.collider, d.contact), collidee = belief(d.collidee, d.contact);
  // The speeds before, as the decision says them, count only as far as the two are believed to be that fast.
  const double believed_m_s = collider.speed_m_s + collidee.speed_m_s;
  const double before_m_s = d.collider_before.velocity.norm() + d.collidee_before.velocity.norm();
  const double fastest_m_s =
      kSpeedGrows * std::min(before_m_s, kSpeedGrows * believed_m_s + kSpeedSlack_m_s) + kSpeedSlack_m_s;
  const auto breaks = [&](ObjectId object, const Belief& of, double extent, const KinematicState& before,
                          const KinematicState& after) -> std::optional<MemberLimit> {
    if (owners_.of(object) == sender || of.positions.empty()) return std::nullopt;
    if (!of.is_near(before.position, extent) || !of.is_near(after.position, extent)) {
      return MemberLimit::kDecisionElsewhere;
    }
    if (after.velocity.norm() > fastest_m_s) return MemberLimit::kDecisionImpossible;
    return std::nullopt;
  };
  const auto first = breaks(d.collider, collider, collider_m, d.collider_before, d.collider_after);
  return first ? first : breaks(d.collidee, collidee, collidee_m, d.collidee_before, d.collidee_after);
}

}  // namespace peerd::replication
