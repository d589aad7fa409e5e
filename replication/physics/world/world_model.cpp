#include "replication/physics/world/world_model.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <unordered_set>

#include "collision/contact/contact_time.hpp"
#include "core/motion/carriers.hpp"
#include "core/motion/founder_objects.hpp"
#include "core/motion/predefined_motion.hpp"
#include "core/scene/interest_pairs.hpp"

namespace peerd::replication {
namespace {

constexpr std::uint32_t kNone = ModelNode::kNone;

template <class T>
void keep_each_once(std::vector<T>& all) {
  std::ranges::sort(all);
  all.erase(std::ranges::unique(all).begin(), all.end());
}

// The number of each listed pair in the model, by its type, its lower and its higher object.
using KnownPairs = std::map<std::tuple<CollisionType, ObjectId, ObjectId>, std::uint32_t>;

// An interest with fewer pairs is listed: to find one in a list is quicker.
constexpr std::size_t kLeastOfGroup = 64;
// Pairs have numbers of 32 bits.
constexpr std::size_t kMostPairs = std::numeric_limits<std::uint32_t>::max();

class ModelBuilder {
 public:
  // `before`: a model whose bodies are used again, of what the scene was before; or null.
  ModelBuilder(const Scene& scene, const WorldModel* before, WorldModel& model)
      : scene_(scene), before_(before), model_(model) {
    if (before == nullptr) return;
    for (const FlexiblePart& part : before->flexible) flexed_before_.push_back(part.shape);
    std::ranges::sort(flexed_before_);
  }

  void build(std::span<const ObjectId> owned) {
    find_ends();
    model_.owned.assign(owned.begin(), owned.end());
    keep_each_once(model_.owned);
    if (named_.empty() && owned.empty()) return;
    predefined_.emplace(scene_);
    bending_ = predefined_->flexible_geometries();
    carriers_.emplace(scene_, *predefined_, movable(owned));
    add_nodes(owned);
    add_bodies();
    note_what_is_carried();
    add_pairs();
    index();
    name_unanswered_pairs();
  }

 private:
  void find_ends() {
    for (const CollisionInterest& interest : scene_.interests) {
      for (const InterestSide* const side : {&interest.colliders, &interest.collidees}) {
        named_.insert(named_.end(), side->ends.begin(), side->ends.end());
      }
    }
    keep_each_once(named_);
  }

  void add_pairs() {
    KnownPairs known;
    for (const CollisionInterest& interest : scene_.interests) {
      const std::size_t most = interest.colliders.ends.size() * interest.collidees.ends.size();
      if (most > kMostPairs - std::max(model_.pairs.size(), model_.part_pairs.size())) {
        throw std::length_error("the interests of the world have more than 2^32 pairs");
      }
      if (is_group(interest)) {
        const PairGroup& group =
            model_.groups.emplace_back(interest.type, group_ends(interest.colliders), group_ends(interest.collidees),
                                       next_number(model_.pairs), next_number(model_.part_pairs));
        model_.pairs.add(group);
        model_.part_pairs.add(group);
        continue;
      }
      InterestPairs(scene_, interest).for_each([&](ObjectId collider, ObjectId collidee) {
        add_pair(known, {collider, collidee, interest.type, false});
      });
    }
  }

  template <class Item>
  [[nodiscard]] static std::uint32_t next_number(const PairList<Item>& list) {
    return static_cast<std::uint32_t>(list.size());
  }

  void add_pair(KnownPairs& known, const CollisionPair& pair) {
    const auto [lower, higher] = std::minmax(pair.collider, pair.collidee);
    const auto [it, is_new] = known.try_emplace({pair.type, lower, higher}, next_number(model_.pairs));
    if (!is_new) {
      CollisionPair& there = model_.pairs.listed(it->second);
      there.mutual |= there.collider != pair.collider;
      return;
    }
    model_.pairs.push_back(pair);
    const std::uint32_t first = next_number(model_.part_pairs);
    add_part_pairs(it->second, pair);
    model_.parts_of_listed_pair.push_back({first, next_number(model_.part_pairs)});
  }

  // Whether the pairs of the interest need no list (PairGroup): they are many, all of one kind, and no other interest
  // of its type has any of them.
  [[nodiscard]] bool is_group(const CollisionInterest& interest) const {
    const std::vector<ObjectId>&colliders = interest.colliders.ends, &collidees = interest.collidees.ends;
    if (colliders.size() < 2 || colliders.size() * collidees.size() < kLeastOfGroup) return false;
    if (!PairGroup::fits(colliders, collidees)) return false;
    std::vector<std::uint32_t> instances;
    std::uint32_t layers = ~0U;
    for (const std::vector<ObjectId>* const ends : {&colliders, &collidees}) {
      for (const ObjectId end : *ends) {
        if (!is_alone(model_.index_of(end))) return false;
        instances.push_back(scene_.index_of(end));
        layers &= scene_.object(end).layers;
      }
    }
    keep_each_once(instances);
    if (layers == 0) return false;
    for (std::size_t i = 1; i < instances.size(); ++i) {  // none is inside another one
      if (scene_.instances[instances[i - 1]].subtree_end > instances[i]) return false;
    }
    const std::unordered_set<ObjectId> of_colliders(colliders.begin(), colliders.end()),
        of_collidees(collidees.begin(), collidees.end());
    const auto has_any = [](const std::unordered_set<ObjectId>& all, const InterestSide& side) {
      return std::ranges::any_of(side.ends, [&](ObjectId end) { return all.contains(end); });
    };
    return std::ranges::none_of(scene_.interests, [&](const CollisionInterest& other) {
      return &other != &interest && other.type == interest.type &&
             ((has_any(of_colliders, other.colliders) && has_any(of_collidees, other.collidees)) ||
              (has_any(of_colliders, other.collidees) && has_any(of_collidees, other.colliders)));
    });
  }

  // Whether the node, as an end, is one rigid body that nothing carries, that carries nothing, and that meets all
  // others of that kind.
  [[nodiscard]] bool is_alone(std::uint32_t node) const {
    const std::vector<std::uint32_t>& parts = model_.parts_of_node[node];
    return parts.size() == 1 && parts.front() == node && model_.nodes[node].carrier == kNone &&
           model_.carried_by[node].empty() && collision::has_exact_answers(model_.bodies[node]);
  }

  [[nodiscard]] std::vector<PairGroup::End> group_ends(const InterestSide& side) const {
    std::vector<PairGroup::End> ends;
    for (const ObjectId end : side.ends) {
      const std::uint32_t node = model_.index_of(end);
      ends.push_back({end, node, model_.nodes[node].is_carrier});
    }
    return ends;
  }

  [[nodiscard]] std::vector<ObjectId> movable(std::span<const ObjectId> owned) const {
    std::vector<ObjectId> ids(owned.begin(), owned.end());
    for (const ObjectId id : named_) {
      if (scene_.at(id).kind == NodeKind::kTransform) ids.push_back(id);
    }
    for (const KeySensor& sensor : scene_.key_sensors) {
      if (sensor.recipient) ids.push_back(*sensor.recipient);
    }
    return ids;
  }

  // Whether the Shape can collide.
  [[nodiscard]] bool collides(ObjectId shape) const {
    return scene_.geometry(shape) != nullptr && scene_.at(shape).collides;
  }

  // The carrier that a node goes with: itself, or the nearest one above it.
  [[nodiscard]] std::optional<ObjectId> mover_of(ObjectId id) const {
    return carriers_->contains(id) ? std::optional(id) : carriers_->above(id);
  }

  // Whether what is below an end, or at it, goes with it: no carrier below the end comes between.
  [[nodiscard]] bool goes_with(ObjectId shape, ObjectId end) const { return carriers_->above(shape) == mover_of(end); }

  void add_nodes(std::span<const ObjectId> owned) {
    std::vector<bool> needed(scene_.instances.size(), false);
    const auto need = [&](ObjectId id) {
      for (std::optional<ObjectId> node = id; node && !needed[scene_.index_of(*node)]; node = carriers_->above(*node)) {
        needed[scene_.index_of(*node)] = true;
      }
    };
    for (const ObjectId end : named_) {
      need(end);
      for (std::uint32_t i = scene_.index_of(end); i < scene_.at(end).subtree_end; ++i) {
        const auto carrier = carriers_->above(scene_.id_of(i));
        if (carrier && scene_.index_of(*carrier) > scene_.index_of(end) && collides(scene_.id_of(i))) need(*carrier);
      }
    }
    // An owned node that is neither carried nor carries anything meets nothing, and moves in the world.
    std::vector<bool> carries(scene_.instances.size(), false);
    for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
      const ObjectId id = scene_.id_of(i);
      const auto above = carriers_->above(id);
      if (above && carriers_->contains(id)) carries[scene_.index_of(*above)] = true;
    }
    for (const ObjectId id : owned) {
      if (carries[scene_.index_of(id)] || carriers_->above(id)) need(id);
    }
    model_.node_of_instance.assign(needed.size(), kNone);
    for (std::uint32_t i = 0; i < needed.size(); ++i) {
      if (!needed[i]) continue;
      model_.node_of_instance[i] = static_cast<std::uint32_t>(model_.nodes.size());
      const ObjectId id = scene_.id_of(i);
      model_.nodes.push_back({id, i, kNone, carriers_->contains(id), 0});
      if (carriers_->contains(id) && predefined_->moves_in_parent(id)) model_.moving.push_back(id);
    }
    for (ModelNode& node : model_.nodes) {
      const auto above = carriers_->above(node.object);
      if (!above) continue;
      node.carrier = model_.index_of(*above);
      node.depth = model_.nodes[node.carrier].depth + 1;
    }
  }

  // The part of a flexible Shape, whichever ends have it.
  [[nodiscard]] std::uint32_t flexible_part(ObjectId shape) {
    const auto next = static_cast<std::uint32_t>(model_.nodes.size() + model_.flexible.size());
    const auto [known, is_new] = part_of_shape_.try_emplace(shape, next);
    if (is_new) {
      const auto carrier = carriers_->above(shape);
      model_.flexible.push_back({carrier ? model_.index_of(*carrier) : kNone, shape});
    }
    return known->second;
  }

  // The bodies of ends and of the carriers below them; the others need none.
  void add_bodies() {
    std::vector<bool> is_part(model_.nodes.size(), false);
    for (const ObjectId end : named_) {
      const std::uint32_t index = model_.index_of(end);
      for (std::uint32_t i = index; i < model_.nodes.size(); ++i) {
        if (model_.nodes[i].instance >= scene_.at(end).subtree_end) break;
        is_part[i] = is_part[i] || i == index || model_.nodes[i].is_carrier;
      }
    }
    for (std::uint32_t i = 0; i < model_.nodes.size(); ++i) {
      const ObjectId id = model_.nodes[i].object;
      const auto belongs = [&](ObjectId shape) {
        if (!is_part[i] || !goes_with(shape, id)) return false;
        if (is_flexible(shape)) flexible_of_node_[i].push_back(flexible_part(shape));
        return !is_flexible(shape);
      };
      const collision::Body* const known = is_part[i] ? same_body(i) : nullptr;
      if (known != nullptr) note_flexible_parts(i, belongs);
      collision::Body body = known != nullptr ? *known : collision::make_body(scene_, id, belongs);
      if (!body.unsupported.empty()) model_.unsupported.push_back(body.unsupported);
      model_.bodies.push_back(std::move(body));
    }
    model_.parts_of_node.resize(model_.nodes.size());
    for (const ObjectId end : named_) {
      const std::uint32_t index = model_.index_of(end);
      std::vector<std::uint32_t>& parts = model_.parts_of_node[index];
      for (std::uint32_t i = index; i < model_.nodes.size(); ++i) {
        if (model_.nodes[i].instance >= scene_.at(end).subtree_end) break;
        const bool has_geometry = !model_.bodies[i].vertices().empty() || !model_.bodies[i].unsupported.empty();
        if (i != index && !model_.nodes[i].is_carrier) continue;
        if (has_geometry) parts.push_back(i);
        if (const auto flexes = flexible_of_node_.find(i); flexes != flexible_of_node_.end()) {
          parts.insert(parts.end(), flexes->second.begin(), flexes->second.end());
        }
      }
      if (parts.empty()) parts.push_back(index);
    }
  }

  void note_flexible_parts(std::uint32_t node, const collision::Belongs& belongs) {
    const ObjectId id = model_.nodes[node].object;
    for (std::uint32_t i = model_.nodes[node].instance; i < scene_.at(id).subtree_end; ++i) {
      if (const ObjectId shape = scene_.id_of(i); collides(shape)) static_cast<void>(belongs(shape));
    }
  }

  struct PlacedShape {
    ObjectId shape;
    const Geometry* geometry;
    Eigen::Affine3d placement;
    bool operator==(const PlacedShape& other) const {
      return shape == other.shape && *geometry == *other.geometry && placement.matrix() == other.placement.matrix();
    }
  };
  // The Shapes that a body consists of: those below its node, but for what goes with carriers below it, and for
  // flexible ones.
  template <class IsFlexible>
  [[nodiscard]] static std::vector<PlacedShape> shapes_of(const WorldModel& model, std::uint32_t node,
                                                          IsFlexible is_flexible) {
    const Scene& scene = *model.scene;
    const ObjectId id = model.nodes[node].object;
    std::vector<PlacedShape> shapes;
    for (std::uint32_t i = model.nodes[node].instance; i < scene.at(id).subtree_end;) {
      const std::uint32_t below = model.node_of_instance[i];
      if (below != kNone && below != node && model.nodes[below].is_carrier) {
        i = scene.instances[i].subtree_end;
        continue;
      }
      const ObjectId shape = scene.id_of(i++);
      const Geometry* const geometry = scene.geometry(shape);
      if (geometry == nullptr || !scene.at(shape).collides || is_flexible(shape)) continue;
      shapes.push_back({shape, geometry, scene.object_from_shape(id, shape)});
    }
    return shapes;
  }

  // The body of a node in the model before, where it consists of the same Shapes now.
  [[nodiscard]] const collision::Body* same_body(std::uint32_t node) const {
    if (before_ == nullptr || scene_.tessellation != before_->scene->tessellation) return nullptr;
    const ObjectId id = model_.nodes[node].object;
    const collision::Body* const body = before_->body(id);
    if (body == nullptr || !body->surface) return nullptr;
    const auto flexed_before = [&](ObjectId shape) { return std::ranges::binary_search(flexed_before_, shape); };
    const auto before = shapes_of(*before_, before_->index_of(id), flexed_before);
    const auto now = shapes_of(model_, node, [&](ObjectId shape) { return is_flexible(shape); });
    // One that was no part of an end then has none of its Shapes.
    return before.size() == body->meshes_built && before == now ? body : nullptr;
  }

  [[nodiscard]] bool is_flexible(ObjectId shape) const {
    return carriers_->distorted(shape) || std::ranges::binary_search(bending_, scene_.at(shape).geometry);
  }

  // The carrier that moves a part.
  [[nodiscard]] std::uint32_t mover(std::uint32_t part) const {
    const std::uint32_t frame = model_.frame_of(part);
    return frame == kNone || model_.nodes[frame].is_carrier ? frame : model_.nodes[frame].carrier;
  }

  [[nodiscard]] std::uint32_t common_carrier(std::uint32_t a, std::uint32_t b) const {
    const auto depth = [&](std::uint32_t node) { return node == kNone ? 0 : model_.nodes[node].depth + 1; };
    std::uint32_t of_a = mover(a), of_b = mover(b);
    while (of_a != of_b) {
      std::uint32_t& deeper = depth(of_a) >= depth(of_b) ? of_a : of_b;
      deeper = model_.nodes[deeper].carrier;
    }
    return of_a;
  }

  void add_part_pairs(std::uint32_t number, const CollisionPair& pair) {
    const auto& of_a = model_.parts_of_node[model_.index_of(pair.collider)];
    const auto& of_b = model_.parts_of_node[model_.index_of(pair.collidee)];
    const bool single =
        of_a.size() + of_b.size() == 2 && !model_.is_flexible(of_a.front()) && !model_.is_flexible(of_b.front());
    if (pair.type == CollisionType::kBox && !single) {
      model_.part_pairs.push_back({number, kNone, kNone, kNone, false});
      return;
    }
    for (const std::uint32_t a : of_a) {
      for (const std::uint32_t b : of_b) {
        if (a == b && model_.is_flexible(a)) continue;        // a Shape does not meet itself
        const bool boxes = pair.type == CollisionType::kBox;  // which change as a carrier turns
        const std::uint32_t common = boxes ? kNone : common_carrier(a, b);
        const bool both_rigid = !model_.is_flexible(a) && !model_.is_flexible(b);
        const bool fixed = both_rigid && mover(a) == mover(b) && (!boxes || mover(a) == kNone);
        model_.part_pairs.push_back({number, a, b, common, fixed});
      }
    }
  }

  void note_what_is_carried() {
    model_.carried_by.resize(model_.nodes.size());
    for (std::uint32_t i = 0; i < model_.nodes.size(); ++i) {
      for (std::uint32_t up = model_.nodes[i].carrier; up != kNone; up = model_.nodes[up].carrier) {
        model_.carried_by[up].push_back(i);
      }
    }
  }

  void index() {
    const std::size_t count = model_.nodes.size();
    model_.node_pairs = model_.node_part_pairs = model_.moved_part_pairs = NodePairs(count);
    model_.pairs.for_each_listed([&](std::uint32_t i, const CollisionPair& pair) {
      const auto [first, end] = model_.part_pairs_of_pair(i);
      for (const ObjectId object : {pair.collider, pair.collidee}) {
        const std::uint32_t node = model_.index_of(object);
        model_.node_pairs.add(node, i);
        for (std::uint32_t k = first; k < end; ++k) model_.node_part_pairs.add(node, k);
      }
    });
    model_.part_pairs.for_each_listed([&](std::uint32_t k, const PartPair& parts) {
      const auto moves = [&](std::uint32_t part) {
        for (const std::uint32_t node : model_.chain_of(part, parts.common)) model_.moved_part_pairs.add(node, k);
      };
      if (parts.a != kNone) {
        moves(parts.a);
        moves(parts.b);
        return;
      }
      const CollisionPair pair = model_.pairs[parts.pair];
      for (const ObjectId end : {pair.collider, pair.collidee}) {
        for (const std::uint32_t part : model_.parts_of_node[model_.index_of(end)]) moves(part);
      }
    });
    for (std::uint32_t i = 0; i < count; ++i) {
      model_.all_pairs_move.push_back(
          std::ranges::equal(model_.moved_part_pairs.listed_of(i), model_.node_part_pairs.listed_of(i)));
    }
    std::vector<const PairGroup*> groups;
    for (const PairGroup& group : model_.groups) groups.push_back(&group);
    model_.node_pairs.add_groups(groups, false);
    model_.node_part_pairs.add_groups(groups, true);
    model_.moved_part_pairs.add_groups(groups, true);
  }

  void name_unanswered_pairs() {
    model_.part_pairs.for_each_listed([&](std::uint32_t, const PartPair& parts) {  // those of groups have an answer
      const CollisionPair pair = model_.pairs[parts.pair];
      if (pair.type == CollisionType::kBox || model_.is_flexible(parts.a) || model_.is_flexible(parts.b)) return;
      const collision::Body &a = model_.bodies[parts.a], &b = model_.bodies[parts.b];
      const bool already_reported = !a.unsupported.empty() || !b.unsupported.empty();
      if (already_reported || collision::has_exact_answer(a, b)) return;
      model_.unsupported.push_back(scene_.path_of(pair.collider) + " against " + scene_.path_of(pair.collidee) +
                                   ": one is not convex, and one is larger than 2^58 m");
    });
  }

  const Scene& scene_;
  const WorldModel* before_;
  WorldModel& model_;
  std::optional<PredefinedMotion> predefined_;
  std::vector<ObjectId> flexed_before_;                                   // Shapes, ascending
  std::vector<std::uint32_t> bending_;                                    // geometries, ascending
  std::map<std::uint32_t, std::vector<std::uint32_t>> flexible_of_node_;  // parts
  std::map<ObjectId, std::uint32_t> part_of_shape_;
  std::vector<ObjectId> named_;  // ends of interests, ascending
  std::optional<Carriers> carriers_;
};

}  // namespace

const collision::Body* WorldModel::body(ObjectId id) const {
  const ModelNode* const of = node(id);
  return of == nullptr ? nullptr : &bodies[static_cast<std::size_t>(of - nodes.data())];
}

PairNumbers WorldModel::pairs_of(ObjectId id) const {
  const ModelNode* const of = node(id);
  if (of == nullptr) return {};
  return pairs_of_node(static_cast<std::size_t>(of - nodes.data()));
}

namespace {

// Whether `holds` of the number of any pair of the two; needs no memory.
template <class Predicate>
bool any_between(const WorldModel& model, ObjectId a, ObjectId b, Predicate holds) {
  if (a == b || model.node(a) == nullptr || model.node(b) == nullptr) return false;
  std::uint32_t of_a = model.index_of(a), of_b = model.index_of(b);
  if (model.node_pairs.listed_of(of_b).size() < model.node_pairs.listed_of(of_a).size()) std::swap(of_a, of_b);
  const ObjectId other = model.nodes[of_b].object;
  const auto is_between = [&](std::uint32_t number) {
    const CollisionPair pair = model.pairs[number];
    return (pair.collider == other || pair.collidee == other) && holds(number);
  };
  if (std::ranges::any_of(model.node_pairs.listed_of(of_a), is_between)) return true;
  return std::ranges::any_of(model.groups, [&](const PairGroup& group) {
    const PairGroup::Member *const one = group.member(of_a), *const another = group.member(of_b);
    if (one == nullptr || another == nullptr) return false;
    const auto number = group.number_of(*one, *another);
    return number && holds(*number);
  });
}

}  // namespace

bool WorldModel::are_paired(ObjectId a, ObjectId b) const {
  return any_between(*this, a, b, [](std::uint32_t) { return true; });
}

std::vector<std::uint32_t> WorldModel::pairs_between(ObjectId a, ObjectId b) const {
  std::vector<std::uint32_t> between;
  any_between(*this, a, b, [&](std::uint32_t number) {
    between.push_back(number);
    return false;
  });
  std::ranges::sort(between);
  return between;
}

std::optional<std::uint32_t> WorldModel::number_of(const InterestKey& interest) const {
  const auto& [type, collider, collidee] = interest;
  for (const std::uint32_t number : pairs_between(collider, collidee)) {
    if (key_of(pairs[number]) == interest) return number;
  }
  return std::nullopt;
}

const CollisionResponse* WorldModel::response_of(ObjectId id) const {
  const auto& response = scene->object(id).response;
  return response ? &*response : nullptr;
}

bool WorldModel::answers(ObjectId id) const {
  return std::ranges::any_of(pairs_of(id), [&](std::uint32_t number) { return answers(pairs[number], id); });
}

bool WorldModel::may_carry(ObjectId carrier, ObjectId object) const {
  if (!scene->contains(object) || !scene->contains(carrier) || carrier == object) return false;
  return scene->at(carrier).kind == NodeKind::kTransform && scene->is_within(object, carrier);
}

bool WorldModel::is_answered(ObjectId a, ObjectId b) const {
  return any_between(*this, a, b, [&](std::uint32_t number) {
    const CollisionPair pair = pairs[number];
    return answers(pair, pair.collider) || answers(pair, pair.collidee);
  });
}

std::vector<std::uint32_t> WorldModel::chain_of(std::uint32_t part, std::uint32_t common) const {
  assert(part < nodes.size() + flexible.size());
  std::vector<std::uint32_t> chain;
  for (std::uint32_t i = frame_of(part); i != kNone && i != common; i = nodes[i].carrier) chain.push_back(i);
  std::ranges::reverse(chain);
  return chain;
}

std::unique_ptr<const WorldModel> make_world_model(const Scene& scene, std::span<const ObjectId> owned) {
  auto model = std::make_unique<WorldModel>();
  model->scene = &scene;
  if (scene.document != nullptr) model->laws = world_laws(*scene.document);
  std::vector<ObjectId> ownable = founder_objects(scene);
  ownable.insert(ownable.end(), owned.begin(), owned.end());
  keep_each_once(ownable);
  ModelBuilder(scene, nullptr, *model).build(ownable);
  return model;
}

bool needs_carrier(const WorldModel& model, ObjectId id, const IsOwned& is_owned) {
  assert(is_owned);
  const Scene& scene = *model.scene;
  if (scene.at(id).kind != NodeKind::kTransform || model.is_carrier(id)) return false;
  const auto moves = [&](ObjectId other) { return model.node(other) != nullptr || is_owned(other); };
  if (model.node(id) != nullptr) return true;
  for (auto above = scene.parent_of(id); above; above = scene.parent_of(*above)) {
    if (moves(*above)) return true;
  }
  for (std::uint32_t below = scene.index_of(id) + 1; below < scene.at(id).subtree_end; ++below) {
    if (moves(scene.id_of(below))) return true;
  }
  return false;
}

std::unique_ptr<const WorldModel> extended(const WorldModel& model, std::span<const ObjectId> moved) {
  std::vector<ObjectId> all(moved.begin(), moved.end());
  all.insert(all.end(), model.owned.begin(), model.owned.end());
  auto next = std::make_unique<WorldModel>();
  next->scene = model.scene;
  next->edited = model.edited;
  next->laws = model.laws;
  ModelBuilder(*model.scene, &model, *next).build(all);
  return next;
}

std::unique_ptr<const WorldModel> edited(const WorldModel& model, std::shared_ptr<const Scene> scene) {
  assert(scene != nullptr && scene.get() != model.scene);
  std::vector<ObjectId> ownable = founder_objects(*scene);
  std::ranges::copy_if(model.owned, std::back_inserter(ownable), [&](ObjectId id) { return scene->contains(id); });
  keep_each_once(ownable);
  auto next = std::make_unique<WorldModel>();
  next->scene = scene.get();
  if (scene->document != nullptr) next->laws = world_laws(*scene->document);
  next->edited = std::move(scene);
  ModelBuilder(*next->scene, &model, *next).build(ownable);
  return next;
}

}  // namespace peerd::replication
