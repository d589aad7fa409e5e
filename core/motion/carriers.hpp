#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "core/motion/predefined_motion.hpp"
#include "core/scene/scene.hpp"

namespace peerd {

// The carriers of a scene: the nodes that something moves as rigid bodies, with all that is below them. A carrier below
// a carrier moves relative to it.
//
//   world ── BUS (carrier) ── DOOR (carrier) ── handle     the handle goes with DOOR, which goes with BUS
//                └── seat                                  the seat goes with BUS
//
// A node below a Transform whose scale is driven, or that is turned below an uneven scale, changes its shape: it is
// distorted. Nothing distorted is a carrier, because no rigid body is where it is.
class Carriers {
 public:
  // `movable`: instances that something else than the world itself may move, such as an owner; in any order. The scene
  // outlives the carriers, at its place.
  Carriers(const Scene& scene, const PredefinedMotion& motion, std::span<const ObjectId> movable);

  [[nodiscard]] bool contains(ObjectId id) const { return nodes_[scene_.index_of(id)].is_carrier; }
  // Returns the nearest carrier above the instance, not itself; none: it is fixed to the world.
  [[nodiscard]] std::optional<ObjectId> above(ObjectId id) const {
    const std::uint32_t above = nodes_[scene_.index_of(id)].above;
    return above == kNone ? std::nullopt : std::optional(scene_.id_of(above));
  }
  // Returns whether the instance, and so all that is below it, changes its shape as the world moves.
  [[nodiscard]] bool distorted(ObjectId id) const { return nodes_[scene_.index_of(id)].distorted; }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  struct Node {
    std::uint32_t above = kNone;
    bool is_carrier = false;
    bool distorted = false;
    bool uneven = false;  // what is below it is scaled unevenly
  };
  const Scene& scene_;
  std::vector<Node> nodes_;  // by instance
};

}  // namespace peerd
