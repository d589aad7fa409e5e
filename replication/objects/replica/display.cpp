#include "replication/objects/replica/display.hpp"

#include <functional>

#include "replication/objects/replica/drawn_way.hpp"

namespace peerd::replication {

Display::Display(const PeerConfig& config, const ModelInForce& model, const OwnObjects& own, const Replica& replica,
                 PeerCounters& counters)
    : config_(config),
      model_(model),
      own_(own),
      replica_(replica),
      counters_(counters),
      bound_(config.bounded_latency) {}

void Display::restart() {
  shown_.clear();
  oldest_update_ = Duration{0};
  bound_.restart();
  late_said_at_.reset();
}

// ---- bounded latency ----

// The picture at a session time t is of t - bound: of what has come before its stamp + the bound, nothing has been
// shown yet.
bool Display::note_late(SimTime stamp, SimTime came) {
  if (!is_bounded()) return false;
  const Duration late_by = came - stamp - bound_.at(came);
  if (late_by < Duration{0}) return false;
  counters_.latest_by = std::max(counters_.latest_by, late_by);
  return true;
}

void Display::on_update(SimTime stamp, SimTime came) { counters_.updates_late += note_late(stamp, came) ? 1 : 0; }

void Display::on_decision(SimTime contact, SimTime came) {
  counters_.decisions_late += note_late(contact, came) ? 1 : 0;
}

// A bound on its way to another one is said when it is there.
std::optional<DelayShown> Display::poll_delay(SimTime t) {
  if (!is_bounded() || !bound_.is_steady_at(t) || said_delay_ == bound_.at(t)) return std::nullopt;
  said_delay_ = bound_.at(t);
  return DelayShown{*said_delay_};
}

std::optional<CameTooLate> Display::poll_late(SimTime t) {
  if (!is_bounded() || (late_said_at_ && t - *late_said_at_ < kLateSaidEvery)) return std::nullopt;
  const CameTooLate all{counters_.updates_late, counters_.updates_missing, counters_.decisions_late,
                        counters_.latest_by};
  const CameTooLate late{all.updates - said_late_.updates, all.missing - said_late_.missing,
                         all.decisions - said_late_.decisions, all.latest_by};
  if (late.updates + late.missing + late.decisions == 0) return std::nullopt;
  late_said_at_ = t;
  said_late_ = all;
  return late;
}

// ---- what is shown ----

Duration Display::delay() const {
  const DisplayDelay& delay = config_.display_delay;
  if (!delay.measured) return delay.fixed;
  const std::uint32_t hz = config_.policy.snapshots_hz;
  return delay.fixed + oldest_update_ + (hz > 0 ? Duration{std::chrono::seconds(1)} / hz : Duration{0});
}

Pose Display::shown(ObjectId object, SimTime t) {
  if (is_bounded()) return replica_.ghost(object, t - bound_.at(t)).pose();
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
