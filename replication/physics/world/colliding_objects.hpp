#pragma once
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "replication/physics/world/model_in_force.hpp"
#include "replication/physics/world/motion_world.hpp"

namespace peerd::replication {

// The eventOut notColliding of an object (Ohlenburg 2003, appendix C.5): false where the object begins to touch what
// an interest pairs it with, true where it touches nothing any more.
struct NotColliding {
  ObjectId object;
  SimTime at;  // the contact time; for true, the tick at which it was found apart
  bool value = true;
};

// The objects that touch something. A contact says when touching begins, a check at every tick when it is over: a
// bounce lasts until the next tick, and an object that lies on a floor collides until it is taken away. Two that lie
// still are not checked until one of them is woken.
class CollidingObjects {
 public:
  explicit CollidingObjects(const ModelInForce& model) : model_(model) {}

  // Ignores pairs that no interest names.
  void on_contact(const ContactEvent& contact);
  // Checks the pairs that touched, but for those that lie. `touch` says whether two objects do so at t
  // (MotionWorld::ends_touch()), `lies` whether an object stands still from then on, until it is woken.
  using Touch = std::function<bool(ObjectId, ObjectId)>;
  using Lies = std::function<bool(ObjectId)>;
  void update(const Touch& touch, const Lies& lies, SimTime t);
  // The motion of the object may have changed.
  void wake(ObjectId object);
  // Session time has stepped, and both worlds begin anew: nothing touches that has no contact there.
  void forget(SimTime t);
  // The scene has been edited, and its model comes in force next: what is not paired any more touches nothing.
  void change_scene(const WorldModel& next, SimTime t);
  // The object is not received any more, so it touches nothing.
  void forget(ObjectId object, SimTime t);

  [[nodiscard]] std::optional<NotColliding> poll();

 private:
  using Pair = std::pair<ObjectId, ObjectId>;  // the lower id first

  void part(const Pair& pair, SimTime t);
  void lay(const Pair& pair);
  // Takes the pair from those that lie.
  void raise(const Pair& pair);

  const ModelInForce& model_;
  std::set<Pair> touching_;                    // those that lie included
  std::set<Pair> checked_;                     // of `touching_`: those that do not lie
  std::set<std::pair<ObjectId, Pair>> lying_;  // the others, by each of the two
  std::map<ObjectId, std::size_t> partners_;   // the number of partners that each object touches, > 0
  std::deque<NotColliding> events_;
};

}  // namespace peerd::replication
