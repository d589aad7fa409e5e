#pragma once
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "replication/motion/motion_world.hpp"

namespace peerd::replication {

// The seed's eventOut notColliding of an object (appendix C.5): false where it begins to touch what an interest pairs
// it with, true where it touches nothing any more.
struct NotColliding {
  ObjectId object;
  SimTime at;  // the contact time; for true the tick at which it was found apart
  bool value = true;
};

// Which objects touch something. Contacts say when that begins, a look at every tick when it is over: a bounce lasts
// until the next tick, what lies on a floor collides until it is taken away.
class CollidingObjects {
 public:
  explicit CollidingObjects(const WorldModel& model);

  // Of a pair that no interest names it is not said.
  void on_contact(const ContactEvent& contact);
  // Looks at pairs that touched: how objects stand at t.
  using StateOf = std::function<KinematicState(ObjectId)>;
  void update(const StateOf& state_of, SimTime t);
  // Another world: nothing touches that has not a contact there.
  void forget(SimTime t);
  // It is not heard of any more, so it touches nothing.
  void forget(ObjectId object, SimTime t);

  [[nodiscard]] std::optional<NotColliding> poll();

 private:
  using Pair = std::pair<ObjectId, ObjectId>;  // the lower id first

  [[nodiscard]] bool touching(const Pair& pair, const StateOf& state_of) const;
  void part(const Pair& pair, SimTime t);

  const WorldModel& model_;
  std::map<Pair, std::vector<CollisionType>> types_;  // of the model's pairs
  std::set<Pair> touching_;
  std::map<ObjectId, std::size_t> partners_;  // of what touches anything
  std::deque<NotColliding> events_;
};

}  // namespace peerd::replication
