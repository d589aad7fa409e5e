#pragma once
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "collision/contact/body.hpp"
#include "core/scene/scene.hpp"

namespace peerd::replication {

// Two ends of interests: nodes of the scene, of which one may be below the other.
struct CollisionPair {
  ObjectId collider, collidee;
  CollisionType type = CollisionType::kWitness;
  bool mutual = false;  // the collidee is registered for the collider as well, and so responds too
};

// A node that collision or a carrier needs: an end of an interest, or a carrier above or below one (core/motion/
// carriers.hpp). The carriers below an end are parts of it that move in it.
struct ModelNode {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  ObjectId object;
  std::uint32_t carrier = kNone;  // index of the nearest carrier above; kNone: fixed to the world, or moved in it
  bool is_carrier = false;
  std::uint32_t depth = 0;  // the number of carriers above
};

// A Shape that changes its shape in the frame of the carrier that it goes with (FlexibleShape).
struct FlexiblePart {
  std::uint32_t carrier = ModelNode::kNone;  // index; kNone: the world
  ObjectId shape;
};

// Two parts, one of each end of a pair, that may meet. The bodies of two types of interests meet part by part; the
// boxes of type kBox are those of whole ends. A part is the body of a node, by its index, or behind all nodes a
// flexible part.
struct PartPair {
  std::uint32_t pair = 0;                   // index in `pairs`
  std::uint32_t a = 0, b = 0;               // parts that meet; kNone: the boxes of both whole ends
  std::uint32_t common = ModelNode::kNone;  // the nearest carrier that both move with: the two meet in its frame
  bool fixed = false;                       // they never move relative to each other
};

// The nodes of one world that collide or carry, with their geometry, and the pairs to watch. Built once per world; a
// peer's two MotionWorlds and every peer of a simulation read the same one.
struct WorldModel {
  const Scene* scene = nullptr;         // outlives the model
  std::vector<ModelNode> nodes;         // sorted by object
  std::vector<collision::Body> bodies;  // of each node: what is below it and goes with it, and with no carrier below it
  std::vector<FlexiblePart> flexible;
  std::vector<CollisionPair> pairs;      // in the file's order, each unordered pair once for each type
  std::vector<PartPair> part_pairs;      // by pair
  std::vector<std::string> unsupported;  // a line for each body that has no exact answer yet
  std::vector<ObjectId> owned;           // what configurations give to peers, sorted
  std::vector<ObjectId> moving;          // carriers that the file itself moves (PredefinedMotion), sorted
  // For each node, ascending and each once: its pairs in `pairs`, and its partners in them as nodes; the part pairs of
  // those; the part pairs that its own motion may change; the nodes below it that go with it; the parts that it
  // consists of as an end.
  std::vector<std::vector<std::uint32_t>> pairs_of_node, partners_of_node, part_pairs_of_node, moved_part_pairs,
      carried_by, parts_of_node;
  std::vector<std::uint32_t> first_part_pair;  // by pair, and one more: the range of its part pairs

  [[nodiscard]] const collision::Body* body(ObjectId id) const;
  [[nodiscard]] const ModelNode* node(ObjectId id) const;  // null where the model does not need it
  // The numbers of an object's pairs; empty where no interest names the object.
  [[nodiscard]] std::span<const std::uint32_t> pairs_of(ObjectId id) const;
  [[nodiscard]] const CollisionResponse* response_of(ObjectId id) const;  // null where the object has none
  // Whether one of the two answers their contacts.
  [[nodiscard]] bool is_answered(ObjectId a, ObjectId b) const;
  [[nodiscard]] bool is_flexible(std::uint32_t part) const { return part >= nodes.size(); }
  [[nodiscard]] const FlexiblePart& flexible_part(std::uint32_t part) const { return flexible[part - nodes.size()]; }
  // The node whose frame a part is in; kNone: the world.
  [[nodiscard]] std::uint32_t frame_of(std::uint32_t part) const {
    return is_flexible(part) ? flexible_part(part).carrier : part;
  }
  // The nodes from the top carrier down to the frame of a part; with `common`, from below that carrier on.
  [[nodiscard]] std::vector<std::uint32_t> chain_of(std::uint32_t part, std::uint32_t common = ModelNode::kNone) const;
};

// `owned`: nodes that peers own, besides those that interests name; they are carriers, too.
[[nodiscard]] std::unique_ptr<const WorldModel> make_world_model(const Scene& scene,
                                                                 std::span<const ObjectId> owned = {});

}  // namespace peerd::replication
