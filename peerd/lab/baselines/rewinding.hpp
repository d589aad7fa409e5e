#pragma once
#include <map>
#include <vector>

#include "core/time.hpp"
#include "replication/physics/world/motion_event.hpp"
#include "replication/physics/world/world_model.hpp"

namespace peerd::baselines {

// Lag compensation (Bernier 2001; Ohlenburg 2003, section 4.2.1): what a player's object hits is decided against the
// other players' objects as that player saw them, by their states of the past. A player with a late view can therefore
// hit an object that has moved on.
class Rewinding {
 public:
  // The model outlives this.
  explicit Rewinding(const replication::WorldModel& model) : model_(model) {}

  // A player's object is there from t on. Times of an object ascend.
  void note(ObjectId object, SimTime t, const Pose& pose);

  // A command moves the object with that state for dt_s from `at` on, as its player counts time, while the player saw
  // the others as they were from `seen` on. Returns its contacts with objects that note() knows, each once until the
  // two are apart at the begin of a command.
  [[nodiscard]] std::vector<replication::ContactEvent> contacts(ObjectId object, const KinematicState& state,
                                                                SimTime at, double dt_s, SimTime seen);

 private:
  [[nodiscard]] Pose pose(ObjectId object, SimTime t) const;

  const replication::WorldModel& model_;
  std::map<ObjectId, std::map<SimTime, Pose>> history_;
  // The pairs that touch, the lower id first, each with the object whose player saw it first: until that player sees
  // them apart, the other player's view of the meeting does not count.
  // The pairs that touch, the lower id first, each with the object whose player saw it first: until that player sees
  // them apart, the other player's view of the meeting does not count.
  std::map<std::pair<ObjectId, ObjectId>, ObjectId> touching_;
};

}  // namespace peerd::baselines
