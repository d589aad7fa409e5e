#pragma once
#include <algorithm>
#include <cassert>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
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

// An InterestKey names an interest in any model of the scene: by its type, its collider and its collidee.
using InterestKey = std::tuple<CollisionType, ObjectId, ObjectId>;
[[nodiscard]] inline InterestKey key_of(const CollisionPair& pair) { return {pair.type, pair.collider, pair.collidee}; }

// A node that collision or a carrier needs: an end of an interest, or a carrier above or below one (core/motion/
// carriers.hpp). The carriers below an end are parts of it that move in it.
struct ModelNode {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  ObjectId object;
  std::uint32_t instance = 0;     // its index in the scene
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
  const Scene* scene = nullptr;         // outlives the model, or is `edited`
  std::shared_ptr<const Scene> edited;  // the scene, where the world has been edited since it began; else null
  std::vector<ObjectId> owned;   // nodes that configurations or the file give to peers, or that others move, ascending
  std::vector<ModelNode> nodes;  // in depth-first order, so that what is below a node is right behind it
  std::vector<std::uint32_t> node_of_instance;  // index in `nodes`, or kNone; empty where there are no nodes
  std::vector<collision::Body> bodies;  // of each node: what is below it and goes with it, and with no carrier below it
  std::vector<FlexiblePart> flexible;
  std::vector<CollisionPair> pairs;      // in the file's order, each unordered pair once for each type
  std::vector<PartPair> part_pairs;      // by pair
  std::vector<std::string> unsupported;  // a line for each body that has no exact answer yet
  std::vector<ObjectId> moving;  // carriers that the world itself moves (PredefinedMotion), in depth-first order
  // For each node, ascending and each once: its pairs in `pairs`, and its partners in them as nodes; the part pairs of
  // those; the part pairs that its own motion may change; the nodes below it that go with it; the parts that it
  // consists of as an end.
  std::vector<std::vector<std::uint32_t>> pairs_of_node, partners_of_node, part_pairs_of_node, moved_part_pairs,
      carried_by, parts_of_node;
  std::vector<bool> all_pairs_move;  // of each node: whether part_pairs_of_node and moved_part_pairs are the same
  std::vector<std::uint32_t> first_part_pair;  // by pair, and one more: the range of its part pairs

  [[nodiscard]] const collision::Body* body(ObjectId id) const;
  [[nodiscard]] const ModelNode* node(ObjectId id) const {  // null where the model does not need it
    if (node_of_instance.empty()) return nullptr;
    const auto instance = scene->ids.find(id, node_of_instance.size());
    if (!instance || node_of_instance[*instance] == ModelNode::kNone) return nullptr;
    return &nodes[node_of_instance[*instance]];
  }
  // The node in whose frame the object moves; none: the world.
  [[nodiscard]] std::optional<ObjectId> carrier_of(ObjectId id) const {
    const ModelNode* const of = node(id);
    if (of == nullptr || of->carrier == ModelNode::kNone) return std::nullopt;
    return nodes[of->carrier].object;
  }
  // Whether an update of `object` may be in the frame of that node: a Transform above it.
  [[nodiscard]] bool may_carry(ObjectId carrier, ObjectId object) const;
  [[nodiscard]] bool is_carrier(ObjectId id) const {
    const ModelNode* const of = node(id);
    return of != nullptr && of->is_carrier;
  }
  // The numbers of an object's pairs; empty where no interest names the object.
  [[nodiscard]] std::span<const std::uint32_t> pairs_of(ObjectId id) const;
  // The part pairs of which a node is an end, and those that its own motion may change; none behind all nodes.
  [[nodiscard]] std::span<const std::uint32_t> part_pairs_of(std::size_t node) const {
    if (node >= part_pairs_of_node.size()) return {};
    return part_pairs_of_node[node];
  }
  [[nodiscard]] std::span<const std::uint32_t> part_pairs_moved_by(std::size_t node) const {
    if (node >= moved_part_pairs.size()) return {};
    return moved_part_pairs[node];
  }
  [[nodiscard]] const CollisionResponse* response_of(ObjectId id) const;  // null where the object has none
  // Whether an end of the pair answers its contacts, being registered for them with a CollisionResponse; whether the
  // object answers those of some pair.
  [[nodiscard]] bool answers(const CollisionPair& pair, ObjectId end) const {
    assert(end == pair.collider || end == pair.collidee);
    return (end == pair.collider || pair.mutual) && response_of(end) != nullptr;
  }
  [[nodiscard]] bool answers(ObjectId id) const;
  // Whether `holds` of any pair of the two.
  template <class Predicate>
  [[nodiscard]] bool any_pair(ObjectId a, ObjectId b, Predicate holds) const {
    if (pairs_of(b).size() < pairs_of(a).size()) std::swap(a, b);
    return std::ranges::any_of(pairs_of(a), [&](std::uint32_t number) {
      return (pairs[number].collider == b || pairs[number].collidee == b) && holds(number);
    });
  }
  [[nodiscard]] bool are_paired(ObjectId a, ObjectId b) const {
    return a != b && any_pair(a, b, [](std::uint32_t) { return true; });
  }
  // Whether one of the two answers their contacts.
  [[nodiscard]] bool is_answered(ObjectId a, ObjectId b) const;
  [[nodiscard]] bool is_flexible(std::uint32_t part) const { return part >= nodes.size(); }
  [[nodiscard]] const FlexiblePart& flexible_part(std::uint32_t part) const { return flexible[part - nodes.size()]; }
  // The node whose frame a part is in; kNone: the world.
  [[nodiscard]] std::uint32_t frame_of(std::uint32_t part) const {
    return is_flexible(part) ? flexible_part(part).carrier : part;
  }
  [[nodiscard]] std::uint32_t index_of(ObjectId id) const {  // of a node that the model needs
    assert(node(id) != nullptr);
    return static_cast<std::uint32_t>(node(id) - nodes.data());
  }
  // Whether `is` holds for a node of chain_of().
  template <class Is>
  [[nodiscard]] bool any_mover(std::uint32_t part, std::uint32_t common, Is is) const {
    for (std::uint32_t i = frame_of(part); i != ModelNode::kNone && i != common; i = nodes[i].carrier) {
      if (is(i)) return true;
    }
    return false;
  }
  // The same for a side of a pair: of a whole end, for what moves any part of it.
  template <class Is>
  [[nodiscard]] bool any_mover(const PartPair& parts, bool of_collider, Is is) const {
    const std::uint32_t part = of_collider ? parts.a : parts.b;
    if (part != ModelNode::kNone) return any_mover(part, parts.common, is);
    const CollisionPair& pair = pairs[parts.pair];
    return std::ranges::any_of(parts_of_node[index_of(of_collider ? pair.collider : pair.collidee)],
                               [&](std::uint32_t each) { return any_mover(each, ModelNode::kNone, is); });
  }
  // The nodes from the top carrier down to the frame of a part; with `common`, from below that carrier on.
  [[nodiscard]] std::vector<std::uint32_t> chain_of(std::uint32_t part, std::uint32_t common = ModelNode::kNone) const;
};

// `owned`: nodes that peers own, besides those that interests name and those that the file gives to the founder; they
// are carriers, too.
[[nodiscard]] std::unique_ptr<const WorldModel> make_world_model(const Scene& scene,
                                                                 std::span<const ObjectId> owned = {});

// Whether the node has to be a carrier of the model, and is not, if somebody moves it: it carries, or is carried by,
// something of the model or what somebody owns.
using IsOwned = std::function<bool(ObjectId)>;
[[nodiscard]] bool needs_carrier(const WorldModel& model, ObjectId id, const IsOwned& is_owned);

// Returns the model with these nodes as carriers, too. Bodies that stay as they are are shared with `model`.
[[nodiscard]] std::unique_ptr<const WorldModel> extended(const WorldModel& model, std::span<const ObjectId> moved);
// Returns the model of what edits have made of the scene of `model`. Bodies whose Shapes stay as they are are shared.
[[nodiscard]] std::unique_ptr<const WorldModel> edited(const WorldModel& model, std::shared_ptr<const Scene> scene);

}  // namespace peerd::replication
