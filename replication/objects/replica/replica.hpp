#pragma once
#include <cassert>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/ids.hpp"
#include "core/kinematics.hpp"
#include "core/object_table.hpp"
#include "core/time.hpp"
#include "replication/physics/world/colliding_objects.hpp"
#include "replication/physics/world/model_in_force.hpp"
#include "replication/physics/world/motion_world.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// This peer's copy of the shared world, in two versions. `truth` holds what is known: own objects as they are, and the
// ghosts of those remote objects that may meet something. `ghosts` holds what all peers predict from the updates, own
// objects included: the sender's copy of every receiver's ghosts. Both begin with the session.
class Replica {
 public:
  struct Worlds {
    MotionWorld truth, ghosts;
  };

  // The model outlives the replica, and so does `detection`, by which both worlds find contacts, if there is one.
  explicit Replica(const ModelInForce& model, TickDetection* detection = nullptr)
      : model_(model), detection_(detection), colliding_(model) {
    if (!model->flexible.empty()) flexible_ = std::make_unique<FlexibleParts>(*model);
  }

  [[nodiscard]] const WorldModel& model() const { return *model_; }
  [[nodiscard]] bool begun() const { return worlds_.has_value(); }
  // Both worlds go on by another model, which comes in force next (MotionWorld::change_model).
  void change_model(const WorldModel& next);
  // Both worlds go on by the model of an edited scene, which comes in force next (MotionWorld::change_scene).
  // `is_moved`: whether something moves the object. The roles are those of objects that are new. Returns
  // the objects that have another place in the truth because of it.
  using RoleOf = std::function<Role(ObjectId)>;
  std::vector<MovingObjects::Placed> change_scene(const WorldModel& next, SimTime at,
                                                  const std::function<bool(ObjectId)>& is_moved,
                                                  const RoleOf& role_in_truth, const RoleOf& role_in_ghosts);
  // Begins both worlds anew at t, with everything at its place in the file, and no pair watched. The ghosts replay
  // their bases: what all peers predict must not depend on the order in which datagrams have come here.
  void begin(SimTime t) {
    worlds_.emplace(Worlds{MotionWorld(*model_, t, MotionWorld::Watched::kNone),
                           MotionWorld(*model_, t, MotionWorld::Watched::kNone)});
    if (flexible_) {
      worlds_->truth.set_flexible(*flexible_);
      worlds_->ghosts.set_flexible(*flexible_);
    }
    if (detection_ != nullptr) {
      worlds_->truth.set_tick_detection(*detection_);
      worlds_->ghosts.set_tick_detection(*detection_);
    }
    changed_.clear();
    worlds_->ghosts.replay_bases();
    begun_at_ = t;
    ++lives_;
  }
  // How often both worlds have begun.
  [[nodiscard]] std::uint64_t lives() const { return lives_; }
  // The time at which both worlds began.
  [[nodiscard]] SimTime begun_at() const {
    assert(begun());
    return begun_at_;
  }
  // The worlds as they were; begin() must follow.
  [[nodiscard]] Worlds take() {
    assert(begun());
    return std::move(*worlds_);
  }

  // The two worlds, which have begun.
  [[nodiscard]] MotionWorld& truth() {
    assert(begun());
    return worlds_->truth;
  }
  [[nodiscard]] const MotionWorld& truth() const {
    assert(begun());
    return worlds_->truth;
  }
  [[nodiscard]] MotionWorld& ghosts() {
    assert(begun());
    return worlds_->ghosts;
  }
  [[nodiscard]] const MotionWorld& ghosts() const {
    assert(begun());
    return worlds_->ghosts;
  }
  // Advances worlds in which searches may be put off.
  class Advancer {
   public:
    virtual ~Advancer() = default;
    // Brings the world to `to`, and finds anew what has become void until its last advance().
    virtual void advance(MotionWorld& world, SimTime to) = 0;
    virtual void catch_up(MotionWorld& world) = 0;
    // The motion of the object is about to be replaced, in some world.
    virtual void before_change(ObjectId object) = 0;
    // Somebody is about to go by the ghost of the object until the last advance(), or by all states.
    virtual void compute_ghost(ObjectId object) = 0;
    virtual void compute_all() = 0;
  };
  // Instead of the worlds themselves; it outlives the replica's use.
  void advance_by(Advancer& advancer) { advancer_ = &advancer; }
  void advance_truth(SimTime to) { advancer_ ? advancer_->advance(truth(), to) : truth().advance(to); }
  void advance_ghosts(SimTime to) { advancer_ ? advancer_->advance(ghosts(), to) : ghosts().advance(to); }
  void catch_up_truth() { advancer_ ? advancer_->catch_up(truth()) : truth().catch_up(); }
  void catch_up_ghosts() { advancer_ ? advancer_->catch_up(ghosts()) : ghosts().catch_up(); }
  // Called before the motion of an object is replaced; set_ghost() and declare_remote() call it.
  void note_change_ahead(ObjectId object) {
    if (advancer_) advancer_->before_change(object);
  }
  // Called before others depend on the ghost of an object that this peer may not see, or on all states.
  void compute_ghost(ObjectId object) {
    if (advancer_) advancer_->compute_ghost(object);
  }
  void compute_all() {
    if (advancer_) advancer_->compute_all();
  }
  // The objects that touch something in the world as this peer knows it.
  [[nodiscard]] CollidingObjects& colliding() { return colliding_; }
  // Wakes those of them whose motion may have changed in either world.
  void note_changes();
  // Calls `function` for the objects whose motion may have changed in either world since the last call.
  template <class Function>
  void take_changed(Function function) {
    note_changes();
    for (const ObjectId object : changed_) function(object);
    changed_.clear();
  }

  // The state of any object at t: by the ghosts, at its place in the file where they do not have it.
  [[nodiscard]] KinematicState ghost(ObjectId object, SimTime t) const;
  // The state of any object at t by the truth; by the ghosts where nothing can meet the object.
  [[nodiscard]] KinematicState truth(ObjectId object, SimTime t) const;

  // Names the polygons that touch in a contact that is reported: in one that the truth has found, or else the ghosts.
  void name_polygons(ContactEvent& contact, bool of_truth) const;

  // The position in the world that an update says [m], by where the ghost of the object's carrier is then.
  [[nodiscard]] Vec3 position_of(const UpdateRecord& update);

  // The session time at which world time began, or that nobody knows it: what flexes does so from then on.
  void set_world_zero(std::optional<SimTime> zero, SimTime t) {
    assert(begun());
    if (!flexible_ || !flexible_->set_world_zero(zero)) return;
    worlds_->truth.reopen_flexible(t);
    worlds_->ghosts.reopen_flexible(t);
  }

  // The motion that an update says, in the frame of the object's carrier here. A sender that does not know of that
  // carrier yet names another frame: of its law, its state counts.
  [[nodiscard]] Base base_of(const UpdateRecord& update);
  // The places of flexible parts; null where nothing flexes.
  [[nodiscard]] FlexibleParts* flexible() const { return flexible_.get(); }

  // Sets the motion that all peers predict for the object from t on, in the frame of its carrier, or what drives it
  // (MotionWorld::set_base). The truth follows unless the object is owned here.
  void set_ghost(ObjectId object, SimTime t, const std::optional<MotionModel>& model, bool owned,
                 const std::optional<Rest>& rest = {}, const std::optional<Vec3>& free = {});
  // The role of an object that is not owned here. One that nothing can meet is in the ghosts alone, and has no place
  // there before this peer receives it for the first time.
  void declare_remote(ObjectId object, Role role);

  // Whether this peer receives the object's updates: false for objects in regions that it does not listen to. What it
  // says of those is void; they meet nothing here.
  [[nodiscard]] bool receives(ObjectId object) const { return !unreceived_.of(object); }
  // Sets whether this peer receives the object. False where that changes nothing.
  bool set_received(ObjectId object, bool received) {
    if (receives(object) == received) return false;
    unreceived_.set(object, !received);
    ++received_revision_;
    return true;
  }
  // A number that changes with what this peer receives.
  [[nodiscard]] std::uint64_t received_revision() const { return received_revision_; }

  // The last update of a remote object that was applied; null before the first.
  [[nodiscard]] const UpdateRecord* last_update_of(ObjectId object) const;
  void note_update(const UpdateRecord& update) {
    assert(update.sequence > 0);
    last_updates_.insert_or_assign(update.object, update);
    keep_update(update);
  }
  void forget_update_of(ObjectId object) { last_updates_.erase(object); }
  void forget_updates() {
    last_updates_.clear();
    kept_updates_.clear();
  }
  // Keeps an update of any object, own ones too, that has an effect on the ghost, for kHistory, if the object may meet
  // anything. Updates of one object come in the order of their sequence.
  void keep_update(const UpdateRecord& update);
  // Keeps an update that comes after one of a higher sequence. False where it is kept already, has no effect on the
  // ghost, or has been overtaken by too many.
  [[nodiscard]] bool keep_overtaken(const UpdateRecord& update);
  // In the order of their times.
  [[nodiscard]] std::span<const UpdateRecord> kept_updates(ObjectId object) const;

 private:
  void renew_flexible(const WorldModel& next);

  const ModelInForce& model_;
  TickDetection* detection_;
  std::optional<Worlds> worlds_;
  SimTime begun_at_{};
  std::uint64_t lives_ = 0;
  CollidingObjects colliding_;
  std::unique_ptr<FlexibleParts> flexible_;  // null: nothing flexes
  Advancer* advancer_ = nullptr;             // null: the worlds themselves
  std::vector<ObjectId> changed_;            // since the last take_changed(); some of them twice
  ObjectTable<bool> unreceived_{false};
  std::uint64_t received_revision_ = 0;
  std::unordered_map<ObjectId, UpdateRecord> last_updates_;
  std::unordered_map<ObjectId, std::vector<UpdateRecord>> kept_updates_;
};

}  // namespace peerd::replication
