#include "replication/replica/display.hpp"

#include <algorithm>

#include "collision/contact/contact_time.hpp"

namespace peerd::replication {

Display::Display(const PeerConfig& config, const ModelInForce& model, const OwnObjects& own, const Replica& replica,
                 PeerCounters& counters)
    : config_(config), model_(model), own_(own), replica_(replica), counters_(counters) {}

void Display::restart() {
  shown_.clear();
  oldest_update_ = Duration{0};
}

Duration Display::delay() const {
  const DisplayDelay& delay = config_.display_delay;
  if (!delay.measured) return delay.fixed;
  const std::uint32_t hz = config_.policy.snapshots_hz;
  return delay.fixed + oldest_update_ + (hz > 0 ? Duration{std::chrono::seconds(1)} / hz : Duration{0});
}

// Whether the way from one place to the other, straight and turned as the ghost is, passes the object's partners as
// they go from where they were drawn with it last.
bool Display::may_pass(ObjectId object, SimTime since, SimTime t, const Vec3& from, const Vec3& to) const {
  const collision::Body* body = model_->body(object);
  if (body == nullptr) return true;
  KinematicState way = at_rest({from, replica_.ghosts().at(object, t).orientation});
  way.velocity = to - from;  // in one second
  return std::ranges::none_of(model_->pairs_of(object), [&](std::uint32_t number) {
    const CollisionPair& pair = model_->pairs[number];
    const ObjectId other = pair.collider == object ? pair.collidee : pair.collider;
    if (!replica_.receives(other)) return false;
    const MotionWorld& drawn = own_.contains(other) ? replica_.truth() : replica_.ghosts();
    const Pose now = drawn.at(other, t).pose();
    const Vec3 then = drawn.has_history_at(other, since) ? drawn.at(other, since).position : now.position;
    KinematicState goes = at_rest({then, now.orientation});
    goes.velocity = now.position - goes.position;
    const collision::ContactState met =
        collision::first_contact({*body, way}, {*model_->body(other), goes}, pair.type, 1.0).state;
    return met == collision::ContactState::kContact || met == collision::ContactState::kOverlapped;
  });
}

Pose Display::shown(ObjectId object, SimTime t) {
  const Duration delay = this->delay();
  if (own_.contains(object)) return replica_.truth(object, config_.display_delay.own ? t - delay : t).pose();
  if (delay > Duration{0}) return replica_.ghost(object, t - delay).pose();
  const KinematicState state = replica_.ghost(object, t);
  const MotionWorld& ghosts = replica_.ghosts();
  if (!ghosts.has(object)) return state.pose();
  Convergence& convergence = shown_.try_emplace(object, config_.convergence).first->second;
  const std::uint64_t blocked = convergence.blocked(), detours = convergence.detours();
  const SimTime since = convergence.last_shown().value_or(t);
  const Pose pose = convergence.shown(
      t, state, ghosts.revision(object),
      [&](const Vec3& from, const Vec3& to) { return may_pass(object, since, t, from, to); },
      [&](SimTime at) {
        return ghosts.has_history_at(object, at) ? std::optional(ghosts.at(object, at).pose()) : std::nullopt;
      });
  counters_.convergence_blocked += convergence.blocked() - blocked;
  counters_.convergence_detours += convergence.detours() - detours;
  return pose;
}

}  // namespace peerd::replication
