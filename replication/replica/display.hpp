#pragma once
#include <algorithm>
#include <unordered_map>

#include "core/ids.hpp"
#include "core/kinematics.hpp"
#include "core/time.hpp"
#include "replication/motion/convergence.hpp"
#include "replication/output/peer_counters.hpp"
#include "replication/policy/peer_config.hpp"
#include "replication/replica/own_objects.hpp"
#include "replication/replica/replica.hpp"

namespace peerd::replication {

// The poses that a viewer draws: ghosts, smoothed where an update has moved them (convergence), or everything late by
// a delay. Nothing that other peers could notice depends on it.
class Display {
 public:
  // All arguments outlive this object.
  Display(const PeerConfig& config, const ModelInForce& model, const OwnObjects& own, const Replica& replica,
          PeerCounters& counters);

  // For each object, t never goes back; the ghosts have been advanced to t. What is shown doesn't go through what an
  // interest pairs the object or what it carries with, where the ghost didn't.
  [[nodiscard]] Pose shown(ObjectId object, SimTime t);

  // An update arrived at that age.
  void on_update_age(Duration age) { oldest_update_ = std::max(oldest_update_, age); }
  // Session time has stepped: nothing shown so far means anything.
  void restart();
  // The object is shown at once where it is.
  void forget(ObjectId object) { shown_.erase(object); }

 private:
  [[nodiscard]] Duration delay() const;

  const PeerConfig& config_;
  const ModelInForce& model_;
  const OwnObjects& own_;
  const Replica& replica_;
  PeerCounters& counters_;
  std::unordered_map<ObjectId, Convergence> shown_;
  Duration oldest_update_{0};  // the greatest age of an update on arrival
};

}  // namespace peerd::replication
