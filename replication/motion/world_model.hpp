#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "collision/contact/body.hpp"
#include "core/scene/scene.hpp"

namespace peerd::replication {

// The geometry that all peers share: one Body for each node that an interest names, and the pairs to watch. Built once
// per world; a peer's two MotionWorlds and every peer of a simulation read the same one.
struct CollisionPair {
  ObjectId collider, collidee;
  CollisionType type = CollisionType::kWitness;
  bool mutual = false;  // the collidee is registered for the collider as well, and so responds too
};
struct WorldModel {
  const Scene* scene = nullptr;          // outlives the model
  std::vector<collision::Body> bodies;   // sorted by object
  std::vector<CollisionPair> pairs;      // in the file's order, each unordered pair once for each type
  std::vector<std::string> unsupported;  // a line for each body that has no exact answer yet
  std::vector<ObjectId> moving;          // bodies that the file itself moves (PredefinedMotion), sorted
  // For each body the numbers of its pairs in `pairs`, and of its partners in `bodies`, both ascending, each partner
  // once.
  std::vector<std::vector<std::uint32_t>> pairs_of_body, partners_of_body;

  [[nodiscard]] const collision::Body* body(ObjectId id) const;
  // The numbers of an object's pairs; empty where no interest names the object.
  [[nodiscard]] std::span<const std::uint32_t> pairs_of(ObjectId id) const;
  [[nodiscard]] const CollisionResponse* response_of(ObjectId id) const;  // null where the object has none
};
[[nodiscard]] std::unique_ptr<const WorldModel> make_world_model(const Scene& scene);

}  // namespace peerd::replication
