#include "replication/replica/display.hpp"

#include <functional>

#include "replication/replica/drawn_way.hpp"

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

Pose Display::shown(ObjectId object, SimTime t) {
  const Duration delay = this->delay();
  if (own_.contains(object)) return replica_.truth(object, config_.display_delay.own ? t - delay : t).pose();
  if (delay > Duration{0}) return replica_.ghost(object, t - delay).pose();
  const KinematicState state = replica_.ghost(object, t);
  const MotionWorld& ghosts = replica_.ghosts();
  if (!ghosts.has(object)) return state.pose();
  const bool marked = model_->scene->object(object).remote;
  Convergence& convergence =
      shown_.try_emplace(object, marked ? config_.remote_convergence : config_.convergence).first->second;
  const std::uint64_t blocked = convergence.blocked(), detours = convergence.detours();
  const SimTime since = convergence.last_shown().value_or(t);
  const auto may_pass = [&](const Vec3& from, const Vec3& to) {
    return is_free(DrawnWay{object, since, t, from, to}, *model_, own_, replica_);
  };
  const auto was = [&](SimTime at) {
    return ghosts.has_history_at(object, at) ? std::optional(ghosts.at(object, at).pose()) : std::nullopt;
  };
  // References suffice: a std::function of that size would take memory for each object of each frame.
  const Pose pose = convergence.shown(t, state, ghosts.revision(object), std::cref(may_pass), std::cref(was));
  counters_.convergence_blocked += convergence.blocked() - blocked;
  counters_.convergence_detours += convergence.detours() - detours;
  return pose;
}

}  // namespace peerd::replication
