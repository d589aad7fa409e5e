#pragma once
#include <algorithm>
#include <cassert>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "collision/contact/body.hpp"
#include "core/scene/scene.hpp"
#include "core/scene/world_laws.hpp"
#include "replication/physics/pairs/model_pairs.hpp"

namespace peerd::replication {

// A node that collision or a carrier needs: an end of an interest, or a carrier above or below one (core/motion/
// carriers.hpp). The carriers below an end are parts of it that move in it.
struct ModelNode {
  static constexpr std::uint32_t kNone = kNoNode;

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

// The nodes of one world that collide or carry, with their geometry, and the pairs to watch. Built once per world; a
// peer's two MotionWorlds and every peer of a simulation read the same one.
struct WorldModel {
  struct Range {
    std::uint32_t first, end;
    [[nodiscard]] std::uint32_t count() const { return end - first; }
  };

  const Scene* scene = nullptr;         // outlives the model, or is `edited`
  std::shared_ptr<const Scene> edited;  // the scene, where the world has been edited since it began; else null
  WorldLaws laws;                       // of the scene
  std::vector<ObjectId> owned;   // nodes that configurations or the file give to peers, or that others move, ascending
  std::vector<ModelNode> nodes;  // in depth-first order, so that what is below a node is right behind it
  std::vector<std::uint32_t> node_of_instance;  // index in `nodes`, or kNone; empty where there are no nodes
  std::vector<collision::Body> bodies;  // of each node: what is below it and goes with it, and with no carrier below it
  std::vector<FlexiblePart> flexible;
  PairList<CollisionPair> pairs;            // in the file's order, each unordered pair once for each type
  PairList<PartPair> part_pairs;            // by pair
  std::vector<Range> parts_of_listed_pair;  // by the pair's place among those of no group
  std::vector<std::string> unsupported;     // a line for each body that has no exact answer yet
  std::vector<ObjectId> moving;  // carriers that the world itself moves (PredefinedMotion), in depth-first order
  // For each node, ascending and each once: the nodes below it that go with it; the parts that it consists of as an
  // end.
  std::vector<std::vector<std::uint32_t>> carried_by, parts_of_node;
  std::deque<PairGroup> groups;           // in the order of their pairs
  NodePairs node_pairs, node_part_pairs;  // of each node: its pairs, and the part pairs of those
  NodePairs moved_part_pairs;             // of each node: the part pairs that its own motion may change
  std::vector<bool> all_pairs_move;  // of each node: whether its part pairs are those that its own motion may change

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
  [[nodiscard]] PairNumbers pairs_of(ObjectId id) const;
  // The pairs of a node, the part pairs of those, and the part pairs that its own motion may change; none behind all
  // nodes.
  [[nodiscard]] PairNumbers pairs_of_node(std::size_t node) const { return node_pairs.of(node); }
  [[nodiscard]] PairNumbers part_pairs_of(std::size_t node) const { return node_part_pairs.of(node); }
  [[nodiscard]] PairNumbers part_pairs_moved_by(std::size_t node) const { return moved_part_pairs.of(node); }
  // The part pairs of a pair: from `first` on, before `end`.
  [[nodiscard]] Range part_pairs_of_pair(std::uint32_t pair) const {
    const auto at = pairs.locate(pair);
    if (at.group == nullptr) return parts_of_listed_pair[at.place];
    const std::uint32_t first = at.group->first_part() + at.place;
    return {first, first + 1};
  }
  [[nodiscard]] const CollisionResponse* response_of(ObjectId id) const;  // null where the object has none
  // Whether an end of the pair answers its contacts, being registered for them with a CollisionResponse; whether the
  // object answers those of some pair.
  [[nodiscard]] bool answers(const CollisionPair& pair, ObjectId end) const {
    assert(end == pair.collider || end == pair.collidee);
    return (end == pair.collider || pair.mutual) && response_of(end) != nullptr;
  }
  [[nodiscard]] bool answers(ObjectId id) const;
  // The world's gravity for the object [m/s^2, world frame]: what answers no contacts would fall through all.
  [[nodiscard]] Vec3 gravity_of(ObjectId id) const { return answers(id) ? laws.gravity : Vec3(Vec3::Zero()); }
  // Calls `function(number)` for each part pair that has these two nodes as its parts.
  template <class Function>
  void for_each_part_pair_between(std::uint32_t a, std::uint32_t b, Function function) const {
    for (const PairNumbers::Stretch& of_a : node_part_pairs.stretches_of(a)) {
      if (of_a.group == nullptr) continue;
      for (const PairNumbers::Stretch& of_b : node_part_pairs.stretches_of(b)) {
        if (of_b.group != of_a.group) continue;
        const auto number = of_a.group->number_of(of_a.member, of_b.member);
        if (number) function(*number - of_a.group->first() + of_a.group->first_part());
      }
    }
    const auto listed_a = node_part_pairs.listed_of(a), listed_b = node_part_pairs.listed_of(b);
    for (const std::uint32_t number : listed_a.size() < listed_b.size() ? listed_a : listed_b) {
      const PartPair parts = part_pairs[number];
      if ((parts.a == a && parts.b == b) || (parts.a == b && parts.b == a)) function(number);
    }
  }
  // The numbers of the pairs of the two, ascending.
  [[nodiscard]] std::vector<std::uint32_t> pairs_between(ObjectId a, ObjectId b) const;
  [[nodiscard]] std::optional<std::uint32_t> number_of(const InterestKey& interest) const;  // none: it has no such pair
  [[nodiscard]] bool are_paired(ObjectId a, ObjectId b) const;
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
