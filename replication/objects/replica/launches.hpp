#pragma once
#include <functional>
#include <map>
#include <vector>

#include "core/ids.hpp"
#include "core/kinematics.hpp"
#include "core/math.hpp"
#include "core/time.hpp"
#include "replication/objects/replica/own_objects.hpp"
#include "replication/objects/replica/replica.hpp"
#include "replication/physics/world/model_in_force.hpp"

namespace peerd::replication {

// Changes of own objects' motion that nobody could predict: the launches of those that physics moves, and velocities
// that a key or a hand has given them.
class Launches {
 public:
  // All arguments outlive this object.
  Launches(const ModelInForce& model, OwnObjects& own, Replica& replica)
      : model_(model), own_(own), replica_(replica) {}

  // The object stands until `at`.
  void schedule(ObjectId object, SimTime at) { scheduled_[object] = at; }
  // Session time has stepped.
  void shift(Duration by);
  // The velocity of an object that begins to move at `at` [m/s, world frame], where its launch names none.
  using FileVelocity = std::function<Vec3(SimTime at, ObjectId object)>;
  // Launches the object at t. Its truth is known until t.
  void launch(SimTime t, ObjectId object, const FileVelocity& file_velocity);
  // Launches the objects that are due until then, in order of time. Advances the truth to each launch.
  void begin_due(SimTime until, const FileVelocity& file_velocity);
  // Gives the object, which this peer owns and nothing drives, the velocity [m/s, world frame] from t on, or adds it to
  // the present one. The truth has been advanced to t.
  void change_velocity(SimTime t, ObjectId object, const Vec3& velocity, bool absolute);

  // What has driven the object, which this peer owns, lets go of it at t in that state in the world. The truth has been
  // advanced to t.
  void let_go(SimTime t, ObjectId object, const KinematicState& world);

  // The object, which this peer owns and nothing drives, begins anew at t: at that place in the frame of its carrier,
  // with that velocity [m/s, world frame], and with the acceleration that it has where nothing bears it. One that is
  // not launched yet stands there until it is. The truth has been advanced to t.
  void begin_anew(SimTime t, ObjectId object, const Pose& place, const Vec3& velocity);

  // The own objects that nothing drives and that have fallen out of the world (WorldLaws::return_below). It looks for
  // them twice a second.
  [[nodiscard]] std::vector<ObjectId> fallen(SimTime t);

  // Changes that have not been published, with the instants since which they hold.
  [[nodiscard]] const std::map<ObjectId, SimTime>& unpublished() const { return unpublished_; }
  void note_published(ObjectId object) { unpublished_.erase(object); }
  void forget_unpublished() { unpublished_.clear(); }
  // Another peer owns the object from now on.
  void forget(ObjectId object);

 private:
  const ModelInForce& model_;
  OwnObjects& own_;
  Replica& replica_;
  std::map<ObjectId, SimTime> scheduled_;
  std::map<ObjectId, SimTime> unpublished_;
  SimTime looked_for_fallen_ = SimTime::min();
};

}  // namespace peerd::replication
