#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "bench/collision_meshes.hpp"
#include "core/kinematics.hpp"
#include "core/scene/scene.hpp"
#include "core/time.hpp"
#include "replication/physics/laws/motion_model.hpp"
#include "replication/physics/world/world_model.hpp"

// This header holds the world whose growth the benchmark measures: bodies that move, and interests in them.
namespace peerd::bench {

// The way of a body: straight legs of 0.5 to 1.5 s between points within 4 m of its home, at constant speed and spin.
class Legs {
 public:
  struct Leg {
    SimTime from;
    replication::MotionModel law;
  };
  explicit Legs(std::vector<Leg> legs);

  [[nodiscard]] std::span<const Leg> all() const { return legs_; }
  [[nodiscard]] const Leg& at_time(SimTime t) const;
  [[nodiscard]] KinematicState at(SimTime t) const;

 private:
  std::vector<Leg> legs_;  // ascending
};

enum class Interests : std::uint8_t {
  kPairs,   // ten a body: one in a hundred with a companion that goes along 2 to 4 m away, all others with anyone
  kGroups,  // as many: all pairs of 21 bodies that have their homes in one cube
};

// Bodies with a bounding radius of 1 m, one to 1,000 m^3, each with one of the meshes. All follows from the number.
struct MovingBodies {
  MovingBodies(std::size_t count, std::span<const NamedSoup> meshes, Interests interests, Duration lasts);
  MovingBodies(const MovingBodies&) = delete;

  [[nodiscard]] ObjectId object(std::size_t i) const {
    return ObjectId{first.number + stride * static_cast<std::uint32_t>(i)};
  }
  [[nodiscard]] std::size_t index(ObjectId id) const { return (id.number - first.number) / stride; }

  Scene scene;
  std::unique_ptr<const replication::WorldModel> model;
  ObjectId first;
  std::uint32_t stride = 1;  // between the ids of two bodies
  std::vector<Legs> legs;    // by body
};

}  // namespace peerd::bench
