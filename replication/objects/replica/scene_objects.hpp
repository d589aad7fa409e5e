#pragma once
#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/objects/replica/owners.hpp"
#include "replication/physics/world/model_in_force.hpp"
#include "replication/physics/world/motion_world.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// A scene object that answers contacts, as far as contacts have moved it.
struct SceneObject {
  SimTime decided{};               // the contact time of the decision that last gave it an owner; SimTime{}: none has
  PeerId decided_by = kNobody;     // that owner, where it is known
  bool is_free = true;             // that owner has let it go, or is gone
  std::uint32_t sequence = 1;      // of the last state or update under that decision
  SimTime freed = SimTime::min();  // the time of the state that its last owner left, and how it moves from then on
  MotionModel model;
  std::optional<ObjectId> carrier{};  // in whose frame the model is; none: the world
  SimTime since{};  // the session time since which this peer, or whoever it has the state from, has computed its way
  std::uint32_t copies = 0;              // of that state: those that this peer still has to send
  std::optional<SimTime> ghost_reset{};  // the instant at which its ghost was last given the motion of the truth
};

// The scene objects that answer contacts, but for those that the caller removes, as a configuration gives them to a
// peer (PeerParts::is_scene_object). As long as nothing but scene objects meets them, they are functions of world time.
// A decision on a contact makes the deciding peer the owner, until the object rests.
class SceneObjects {
 public:
  explicit SceneObjects(const ModelInForce& model);

  [[nodiscard]] bool contains(ObjectId object) const { return all_.contains(object); }
  // Whether the object is one of them and answers contacts of the pair.
  [[nodiscard]] bool answers(const CollisionPair& pair, ObjectId object) const;
  [[nodiscard]] SceneObject& at(ObjectId object) { return all_.at(object); }
  [[nodiscard]] const SceneObject& at(ObjectId object) const { return all_.at(object); }
  [[nodiscard]] const std::map<ObjectId, SceneObject>& all() const { return all_; }
  // The model in force is of an edited scene since then: what answers contacts there and nobody owns is one of them,
  // and what was one before stays one. Returns those that are new.
  std::vector<ObjectId> follow_model(SimTime since, const Owners& owners);
  // A configuration or an operation gives the object to a peer.
  void remove(ObjectId object);

  // The contact time of the decision that last gave the object an owner; SimTime{}: none has, or it is none of them.
  [[nodiscard]] SimTime decided(ObjectId object) const;
  // Those that a contact has moved: the file does not move them any more.
  [[nodiscard]] bool is_moved(ObjectId object) const { return moved_.contains(object); }
  void note_moved(ObjectId object);
  // The only contacts that have moved it are retracted: the file moves it again.
  void note_unmoved(ObjectId object);
  // An edit gives the object another place: what has moved it until then does not count any more.
  void place(ObjectId object, SimTime at, const MotionModel& law, std::optional<ObjectId> carrier);
  // Those whose ghosts have met something, each with the time since which its ghost does not move as the truth does.
  [[nodiscard]] std::map<ObjectId, SimTime>& differing() { return differing_; }

  // Those that decisions have given to this peer.
  [[nodiscard]] std::set<ObjectId>& adopted() { return adopted_; }
  // Those that this peer has let go, and of which copies of the state are still to be sent.
  [[nodiscard]] std::vector<ObjectId>& left() { return left_; }

  // This peer computes what scene objects meet from now on. Of two peers, what the earlier one has computed counts.
  void restart(SimTime now);
  // The worlds have begun anew: those that contacts have moved go on from where they are by now.
  void restart_moved(SimTime now);
  // Session time has stepped into another session's.
  void shift(Duration by);

  // Whether a state counts that nobody's object has by what another peer says. `sequence`: of the last update or state
  // under that decision that this peer knows.
  [[nodiscard]] bool supersedes(const UpdateRecord& state, SimTime since) const;

  // The states of those that contacts have moved and nobody owns, as the truth has them, which has been advanced to
  // `now`.
  [[nodiscard]] std::vector<UpdateRecord> states(const Owners& owners, const MotionWorld& truth, SimTime now) const;
  // A digest of the same: peers that have the same have one digest at the same `at`, which lies somewhat in the past.
  // 0: there are none.
  [[nodiscard]] std::uint64_t digest(const Owners& owners, const MotionWorld& truth, SimTime at) const;

 private:
  std::vector<ObjectId> add_all(SimTime since, const Owners& owners);

  const ModelInForce& model_;
  std::map<ObjectId, SceneObject> all_;
  std::set<ObjectId> moved_;  // ordered: they are sent in this order
  std::map<ObjectId, SimTime> differing_;
  std::set<ObjectId> adopted_;
  std::vector<ObjectId> left_;
};

}  // namespace peerd::replication
