#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "collision/broad_phase/broad_pair.hpp"
#include "core/ids.hpp"

namespace peerd::collision {

// A Transform's eventOut notColliding (thesis, C.5): FALSE when the Transform begins to collide with anything, as a
// collider or as a collidee, TRUE when it no longer does.
struct NotColliding {
  ObjectId object;
  bool value = false;
  friend bool operator==(const NotColliding&, const NotColliding&) = default;
};

// An interest that has no answer, and why.
struct RefusedInterest {
  std::uint32_t interest = 0;
  std::string why;
};

// Keeps which interests collide, tick after tick, and derives what began and ended and what Transforms report.
// Interests and objects have dense indices, in the order in which they were added.
class CollisionChanges {
 public:
  // All sorted by interest or object; valid until the next begin_tick().
  struct Tick {
    std::span<const std::uint32_t> colliding;
    std::span<const std::uint32_t> began, ended;  // since the last tick
    std::span<const NotColliding> not_colliding;  // since the last tick; none in the first for what doesn't collide
    std::span<const RefusedInterest> refused;     // these count as not colliding
  };

  // Objects are added in the order of their ids. Only Transforms report notColliding.
  void add_object(ObjectId id, bool is_transform);
  void add_interest(BroadIndex collider, BroadIndex collidee);

  void begin_tick();
  // Whether that changed anything.
  bool set_colliding(std::uint32_t interest, bool colliding);
  void refuse(std::uint32_t interest, const std::string& why);
  void accept(std::uint32_t interest);  // takes a refusal back, if there is one
  const Tick& end_tick();

  [[nodiscard]] bool is_colliding(std::uint32_t interest) const { return is_colliding_[interest] != 0; }
  [[nodiscard]] bool is_refused(std::uint32_t interest) const { return refusals_.contains(interest); }

 private:
  struct Object {
    ObjectId id;
    bool is_transform = false;
    bool was_colliding = false;    // whether it collided at the last tick
    bool changed = false;          // listed in changed_objects_
    std::uint32_t collisions = 0;  // the number of its interests that collide
  };
  struct Interest {
    BroadIndex collider, collidee;
  };

  std::vector<Object> objects_;
  std::vector<Interest> interests_;
  std::vector<std::uint8_t> is_colliding_;  // by interest
  std::map<std::uint32_t, std::string> refusals_;
  bool refusals_changed_ = false;
  std::vector<BroadIndex> changed_objects_;  // objects of which an interest began or ended
  std::vector<std::uint32_t> colliding_, began_, ended_, merged_;
  std::vector<NotColliding> not_colliding_;
  std::vector<RefusedInterest> refused_;
  Tick result_;
};

}  // namespace peerd::collision
