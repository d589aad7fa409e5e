#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>
#include <unordered_map>

#include "core/ids.hpp"
#include "core/kinematics.hpp"
#include "core/time.hpp"
#include "replication/objects/replica/bounded_delay.hpp"
#include "replication/objects/replica/own_objects.hpp"
#include "replication/objects/replica/replica.hpp"
#include "replication/physics/laws/convergence.hpp"
#include "replication/settings/output/output.hpp"
#include "replication/settings/output/peer_counters.hpp"
#include "replication/settings/policy/peer_config.hpp"

namespace peerd::replication {

// The poses that a viewer draws: ghosts, smoothed where an update has moved them (convergence), or everything late by
// a delay. Nothing that other peers could notice depends on it.
//
// With BoundedLatency it is the ghosts of `bound` ago, of own objects too: what all peers have made of the updates and
// decisions until then, which is one function of these (README, invariants). So two peers that have all of them show
// the same at one session time, to the last bit.
class Display {
 public:
  // All arguments outlive this object.
  Display(const PeerConfig& config, const ModelInForce& model, const OwnObjects& own, const Replica& replica,
          PeerCounters& counters);

  // For each object, t never goes back; the ghosts have been advanced to t. What is shown doesn't go through what an
  // interest pairs the object or what it carries with, where the ghost didn't.
  [[nodiscard]] Pose shown(ObjectId object, SimTime t);

  // An update, or a decision, of that time arrived at session time `came`.
  void on_update(SimTime stamp, SimTime came);
  void on_decision(SimTime contact, SimTime came);
  // So many updates of one object have not come, and never will count: a newer one has.
  void on_missing(std::uint64_t updates) {
    if (is_bounded()) counters_.updates_missing += updates;
  }
  // A peer, which may be this one, has sent at that session time that its latency is so long; it is `now` here.
  void on_latency(SimTime sent, Duration latency, SimTime now) { bound_.on_published(sent, latency, now); }
  // Whether all is shown as it was a bound ago, the bound at a time of about now; and what is to be said of it, if it
  // is to be said now.
  [[nodiscard]] bool is_bounded() const { return config_.bounded_latency.is_on(); }
  [[nodiscard]] Duration bound(SimTime t) { return bound_.at(t); }
  [[nodiscard]] std::optional<DelayShown> poll_delay(SimTime t);
  [[nodiscard]] std::optional<CameTooLate> poll_late(SimTime t);

  // An update arrived at that age.
  void on_update_age(Duration age) { oldest_update_ = std::max(oldest_update_, age); }
  // Session time has stepped: nothing shown so far means anything.
  void restart();
  // The object is shown at once where it is.
  void forget(ObjectId object) { shown_.erase(object); }

 private:
  [[nodiscard]] Duration delay() const;
  [[nodiscard]] bool note_late(SimTime stamp, SimTime came);

  const PeerConfig& config_;
  const ModelInForce& model_;
  const OwnObjects& own_;
  const Replica& replica_;
  PeerCounters& counters_;
  std::unordered_map<ObjectId, Convergence> shown_;
  Duration oldest_update_{0};  // the greatest age of an update on arrival
  BoundedDelay bound_;
  std::optional<Duration> said_delay_;
  std::optional<SimTime> late_said_at_;
  CameTooLate said_late_;  // the counts of all times
};

}  // namespace peerd::replication
