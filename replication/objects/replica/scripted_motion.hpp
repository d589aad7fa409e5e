#pragma once
#include <optional>
#include <vector>

#include "core/ids.hpp"
#include "core/motion/predefined_motion.hpp"
#include "core/time.hpp"
#include "replication/objects/replica/owners.hpp"
#include "replication/objects/replica/replica.hpp"
#include "replication/objects/replica/scene_objects.hpp"
#include "replication/physics/world/model_in_force.hpp"

namespace peerd::replication {

// The motion of objects that the world's own file moves by its TimeSensors and ROUTEs: the same function of world time
// on all peers, which costs no update. While a peer owns such an object, the owner moves it instead.
class ScriptedMotion {
 public:
  // The model outlives this.
  explicit ScriptedMotion(const ModelInForce& model);

  // Begins the motion anew, after both worlds or world time have begun anew: the worlds are given the motion from now
  // on.
  void restart();
  // The model in force has changed: objects that it moves in addition, or relative to another carrier, begin anew.
  void follow_model();
  // The model in force is of an edited scene, since then: what it moves otherwise, or in addition, begins there.
  // Returns the objects that it moved before and moves no more.
  [[nodiscard]] std::vector<ObjectId> follow_scene(SimTime at, std::optional<SimTime> world_zero);
  // Gives both worlds of the replica, which have begun, the motion until `to`. Does nothing before world time is
  // known. Pieces begin at the same instants with the same bits on every peer, whenever it joined; but an object that
  // a peer owned until now is not moved in its past, and one that a contact has moved goes on by itself.
  void extend(SimTime to, std::optional<SimTime> world_zero, const Owners& owners, const SceneObjects& scene,
              Replica& replica);

  // A vector in the frame of the object's parent, in which the file has velocities, turned into the world's frame as
  // the parent stands at that time.
  [[nodiscard]] Vec3 to_world(SimTime at, std::optional<SimTime> world_zero, ObjectId object, const Vec3& in_parent);
  // World time [s] since which the world's TimeSensors stand still; none: they do not (PredefinedMotion).
  [[nodiscard]] std::optional<double> limited_at() const {
    return motion_ ? motion_->transition_limit_reached_at() : std::nullopt;
  }

 private:
  // An object with the time until which both worlds have its motion (none: they have none yet), and the time until
  // which a peer owned it.
  struct Piece {
    ObjectId object;
    std::optional<ObjectId> carrier;  // its motion is relative to it
    std::optional<SimTime> known_until, owned_until;
    std::optional<PredefinedMotion::Piece> last{};  // the one that both worlds have been given last
  };

  void extend(Piece& piece, SimTime to, SimTime world_zero, Replica& replica);
  void extend_answering(SimTime to, SimTime world_zero, const Owners& owners, const SceneObjects& scene,
                        Replica& replica);

  const ModelInForce& model_;
  std::optional<PredefinedMotion> motion_;  // none: the file moves no body
  std::vector<Piece> pieces_;
};

}  // namespace peerd::replication
