#include "core/vrml/scene_builder.hpp"

#include <algorithm>
#include <cassert>
#include <unordered_set>
#include <utility>

#include "core/vrml/mesh_builder.hpp"
#include "core/vrml/parser.hpp"
#include "core/vrml/rotation.hpp"

namespace peerd::vrml {
namespace {

constexpr std::int32_t kNoMesh = -1;
constexpr std::uint32_t kNone = NodeRef::kNull;

Vec3 to_vec3(const Floats& f) { return {f[0], f[1], f[2]}; }

bool is_instance(Meaning meaning) {
  return meaning == Meaning::kGroup || meaning == Meaning::kTransform || meaning == Meaning::kShape;
}

class Builder {
 public:
  Builder(const NodeTree& tree, std::string_view text, Problems& problems)
      : tree_(tree), text_(text), problems_(problems) {}

  Scene build();

 private:
  template <class T>
  const T& value(const Node& node, std::string_view field);
  const Node* referred(const Node& node, std::string_view field);

  std::int32_t add_mesh(const Node& node);
  Instance make_instance(const Node& node);
  void make_transform(const Node& node, Instance& instance);
  void make_shape(const Node& node, Instance& instance);
  CollisionResponse make_response(const Node& node);
  const std::vector<NodeRef>& children(const Node& node);
  bool measure_instances();
  void instantiate(const NodeRef& ref, std::int32_t parent, std::uint32_t child_index);
  void mark_shadowed_names();
  void add_interest(const Node& node);
  std::optional<ObjectId> resolve(std::string_view path, const Spot& spot);

  const NodeTree& tree_;
  std::string_view text_;
  Problems& problems_;
  Scene scene_;
  std::unordered_map<const FieldSpec*, Value> defaults_;
  std::vector<std::int32_t> mesh_of_;        // by node; kNoMesh where it is no geometry with polygons
  std::vector<std::uint32_t> prototype_of_;  // by node, into prototypes_; kNone where it is no instance
  std::vector<Instance> prototypes_;
  std::unordered_map<std::string_view, std::uint32_t> first_of_name_;
};

// A field's value as the text or the table gives it.
template <class T>
const T& Builder::value(const Node& node, std::string_view field) {
  if (const FieldValue* given = node.find(field)) return std::get<T>(given->value);
  const FieldSpec* spec = find_field(*node.type, field);
  assert(spec != nullptr);
  const auto [it, is_new] = defaults_.try_emplace(spec);
  if (is_new) it->second = default_value(*spec).value();
  return std::get<T>(it->second);
}

const Node* Builder::referred(const Node& node, std::string_view field) {
  const NodeRef& ref = value<NodeRef>(node, field);
  return ref ? &tree_.nodes[ref.index] : nullptr;
}

const std::vector<NodeRef>& Builder::children(const Node& node) {
  static const std::vector<NodeRef> kNoChildren;
  return node.type->meaning == Meaning::kShape ? kNoChildren : value<std::vector<NodeRef>>(node, "children");
}

std::int32_t Builder::add_mesh(const Node& node) {
  std::optional<Mesh> mesh;
  if (node.type->meaning == Meaning::kBox && !node.damaged) {
    mesh = box_mesh(value<Floats>(node, "size"));
    mesh->where = node.spot.where;
  } else if (node.type->meaning == Meaning::kIndexedFaceSet) {
    mesh = indexed_face_set_mesh(tree_, node, text_, problems_);
  }
  if (!mesh || mesh->polygon_count() == 0) return kNoMesh;
  scene_.meshes.push_back(std::move(*mesh));
  return static_cast<std::int32_t>(scene_.meshes.size() - 1);
}

CollisionResponse Builder::make_response(const Node& node) {
  CollisionResponse response;
  const std::int32_t type = value<std::int32_t>(node, "responseType");
  if (type > 1) {
    problems_.error(node.find("responseType")->spot,
                    "responseType must be 0 (CRT_INVERSE) or 1 (CRT_ZERO), found " + std::to_string(type));
  }
  response.type = static_cast<ResponseType>(type);
  response.set_back = value<bool>(node, "setBack");
  return response;
}

void Builder::make_transform(const Node& node, Instance& instance) {
  instance.kind = NodeKind::kTransform;
  TransformFields& t = instance.transform;
  t.translation = to_vec3(value<Floats>(node, "translation"));
  t.rotation = to_quat(value<Floats>(node, "rotation"));
  t.scale = to_vec3(value<Floats>(node, "scale"));
  t.scale_orientation = to_quat(value<Floats>(node, "scaleOrientation"));
  t.center = to_vec3(value<Floats>(node, "center"));
  if (!(t.scale.minCoeff() > 0.0)) {
    problems_.warning(node.find("scale")->spot, "a scale of 0 or less is outside VRML97; it is applied as written");
  }
  instance.velocity = to_vec3(value<Floats>(node, "velocityVector"));
  instance.distance_threshold_m = value<Floats>(node, "distanceThreshold")[0];
  if (const Node* response = referred(node, "collisionResponse")) instance.response = make_response(*response);
}

void Builder::make_shape(const Node& node, Instance& instance) {
  instance.kind = NodeKind::kShape;
  instance.convex_hull = to_points(value<std::vector<float>>(node, "convexHull"));
  instance.hierarchy_file = value<std::string>(node, "hierarchyFile");
  instance.split_threshold = value<std::int32_t>(node, "splitThreshold");
  const NodeRef& geometry = value<NodeRef>(node, "geometry");
  if (!geometry) return;
  instance.mesh = mesh_of_[geometry.index];
  const NodeType& type = *tree_.nodes[geometry.index].type;
  if (type.meaning == Meaning::kOtherGeometry) instance.unsupported_geometry = type.name;
}

Instance Builder::make_instance(const Node& node) {
  Instance instance;
  instance.def = node.def;
  if (node.type->meaning == Meaning::kTransform) make_transform(node, instance);
  if (node.type->meaning == Meaning::kShape) make_shape(node, instance);
  return instance;
}

// Whether the scene is small enough to instantiate. Children stand before their parents in the tree, so one pass knows
// each node's instances and height; a chain of USE can be deeper and larger than any text.
bool Builder::measure_instances() {
  std::vector<std::uint64_t> count(tree_.nodes.size(), 0);
  std::vector<std::uint32_t> height(tree_.nodes.size(), 0);
  const std::size_t errors = problems_.errors();
  bool too_many = false;
  const auto add = [&](const NodeRef& ref, std::uint64_t& total) {
    if (total + count[ref.index] > kMaxInstances && !std::exchange(too_many, true)) {
      problems_.error(ref.spot,
                      "with this node the world has more than " + std::to_string(kMaxInstances) + " instances");
    }
    total = std::min(total + count[ref.index], kMaxInstances + 1);
  };
  for (std::size_t i = 0; i < tree_.nodes.size(); ++i) {
    const Node& node = tree_.nodes[i];
    if (!is_instance(node.type->meaning)) continue;
    count[i] = height[i] = 1;
    for (const NodeRef& child : children(node)) {
      if (!child) continue;
      if (height[child.index] == kMaxNesting) {
        problems_.error(child.spot, "instances are nested more than " + std::to_string(kMaxNesting) + " deep here");
      }
      height[i] = std::max(height[i], std::min(height[child.index] + 1, kMaxNesting + 1));
      add(child, count[i]);
    }
  }
  std::uint64_t total = 0;
  for (const NodeRef& ref : tree_.top_level) {
    if (ref) add(ref, total);
  }
  if (problems_.errors() != errors) return false;
  scene_.instances.reserve(total);
  return true;
}

void Builder::instantiate(const NodeRef& ref, std::int32_t parent, std::uint32_t child_index) {
  if (!ref || prototype_of_[ref.index] == kNone) return;
  const auto id = static_cast<std::uint32_t>(scene_.instances.size());
  Instance& instance = scene_.instances.emplace_back(prototypes_[prototype_of_[ref.index]]);
  instance.parent = parent;
  instance.child_index = child_index;
  instance.where = ref.spot.where;
  std::uint32_t i = 0;
  for (const NodeRef& child : children(tree_.nodes[ref.index])) instantiate(child, static_cast<std::int32_t>(id), i++);
  scene_.instances[id].subtree_end = static_cast<std::uint32_t>(scene_.instances.size());
}

void Builder::mark_shadowed_names() {
  auto& instances = scene_.instances;
  for (std::uint32_t i = 0; i < instances.size(); ++i) {
    if (instances[i].def.empty()) continue;
    const bool first = first_of_name_.emplace(instances[i].def, i).second;
    if (instances[i].parent < 0) instances[i].name_shadowed = !first;
  }
  std::unordered_set<std::string_view> siblings;
  for (std::uint32_t parent = 0; parent < instances.size(); ++parent) {
    siblings.clear();
    for (std::uint32_t i = parent + 1; i < instances[parent].subtree_end; i = instances[i].subtree_end) {
      if (!instances[i].def.empty()) instances[i].name_shadowed = !siblings.insert(instances[i].def).second;
    }
  }
}

// Nothing is reported for a name that was lost in an error.
std::optional<ObjectId> Builder::resolve(std::string_view path, const Spot& spot) {
  if (const auto it = first_of_name_.find(path); it != first_of_name_.end()) return ObjectId{it->second};
  if (const auto id = scene_.find(path)) return id;
  const auto defined = tree_.defined.find(path.substr(0, path.find('/')));
  if (defined != tree_.defined.end() && defined->second.index == NodeRef::kNull) return std::nullopt;
  if (const auto it = tree_.defined.find(path); it != tree_.defined.end()) {
    const std::string type(tree_.nodes[it->second.index].type->name);
    problems_.error(spot, quoted(path) + " is a " + type + ", not a Group, Transform or Shape of the scene");
    return std::nullopt;
  }
  Suggestion suggestion(path);
  constexpr std::size_t kFewEnough = 4096;
  if (first_of_name_.size() <= kFewEnough) {
    for (const Instance& instance : scene_.instances) suggestion.consider(instance.def);
  }
  problems_.error(spot, "no node of the scene is named " + quoted(path) + did_you_mean(suggestion));
  return std::nullopt;
}

void Builder::add_interest(const Node& node) {
  CollisionInterest interest;
  interest.where = node.spot.where;
  const std::int32_t type = value<std::int32_t>(node, "collisionType");
  if (type > 2) {
    problems_.error(node.find("collisionType")->spot,
                    "collisionType must be 0 (box), 1 (witness) or 2 (all pairs), found " + std::to_string(type));
  }
  interest.type = static_cast<CollisionType>(type);
  const FieldValue* path = node.find("objectPath");
  std::optional<ObjectId> collider;
  if (path != nullptr) {
    collider = resolve(std::get<std::string>(path->value), path->spot);
  } else if (!node.damaged) {
    problems_.error(node.spot, "this CollisionInterest has no objectPath: it must name the node that is registered");
  }

  std::unordered_set<ObjectId> seen;
  for (const std::string_view field : {"interests", "collisionInterests"}) {
    const FieldValue* list = node.find(field);
    if (list == nullptr) continue;
    const auto& names = std::get<std::vector<std::string>>(list->value);
    ElementSpots spots(text_, *list);
    for (std::size_t i = 0; i < names.size() && !problems_.full(); ++i) {
      const Spot spot = spots.at(i);
      const auto collidee = resolve(names[i], spot);
      if (!collidee) continue;
      if (collidee == collider) {
        problems_.error(spot, quoted(names[i]) + " is the collider itself");
      } else if (!seen.insert(*collidee).second) {
        problems_.warning(spot, quoted(names[i]) + " is listed twice; it counts once");
      } else {
        interest.collidees.push_back(*collidee);
      }
    }
  }
  if (seen.empty() && !node.damaged) problems_.warning(node.spot, "this CollisionInterest has no interests");
  if (!collider) return;
  interest.collider = *collider;
  scene_.interests.push_back(std::move(interest));
}

Scene Builder::build() {
  mesh_of_.assign(tree_.nodes.size(), kNoMesh);
  prototype_of_.assign(tree_.nodes.size(), kNone);
  for (std::size_t i = 0; i < tree_.nodes.size(); ++i) {
    const Node& node = tree_.nodes[i];
    mesh_of_[i] = add_mesh(node);
    if (!is_instance(node.type->meaning)) continue;
    prototype_of_[i] = static_cast<std::uint32_t>(prototypes_.size());
    prototypes_.push_back(make_instance(node));
  }
  if (!measure_instances()) return {};
  for (std::uint32_t i = 0; i < tree_.top_level.size(); ++i) instantiate(tree_.top_level[i], -1, i);
  mark_shadowed_names();
  for (const Node& node : tree_.nodes) {
    if (node.type->meaning == Meaning::kCollisionInterest) add_interest(node);
  }
  return std::move(scene_);
}

}  // namespace

Scene build_scene(const NodeTree& tree, std::string_view text, Problems& problems) {
  return Builder(tree, text, problems).build();
}

}  // namespace peerd::vrml
