#include "core/scene/scene_builder.hpp"

#include <algorithm>
#include <cassert>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "core/geometry/tessellate.hpp"
#include "core/scene/geometry_reader.hpp"
#include "core/scene/interest_reader.hpp"
#include "core/scene/object_finder.hpp"
#include "core/scene/rotation.hpp"
#include "core/vrml/default_values.hpp"
#include "core/vrml/name_table.hpp"

namespace peerd::vrml {
namespace {

constexpr std::uint32_t kNone = Instance::kNone;
constexpr std::uint32_t kTop = kNone - 1;  // no instance: the top level

Vec3 to_vec3(const Field& field) {
  const auto f = field.as<float>();
  return {f[0], f[1], f[2]};
}

Quat rotation_of(const Field& field) { return to_quat(field.as<float>().first<4>()); }

bool is_instance(NodeRole role) { return role >= NodeRole::kGroup && role <= NodeRole::kShape; }

NodeKind kind_of(NodeRole role) {
  switch (role) {
    case NodeRole::kTransform:
      return NodeKind::kTransform;
    case NodeRole::kBillboard:
      return NodeKind::kBillboard;
    case NodeRole::kCollision:
      return NodeKind::kCollision;
    case NodeRole::kInline:
      return NodeKind::kInline;
    case NodeRole::kLod:
      return NodeKind::kLod;
    case NodeRole::kSwitch:
      return NodeKind::kSwitch;
    case NodeRole::kShape:
      return NodeKind::kShape;
    default:
      return NodeKind::kGroup;
  }
}

class Builder {
 public:
  Builder(const std::shared_ptr<const Document>& document, const Tessellation& tessellation, const ReadLimits& limits,
          Problems& problems, const Bindings* bindings = nullptr, const Around& around = {})
      : document_(document),
        nodes_(document->nodes),
        tessellation_(tessellation),
        limits_(limits),
        problems_(problems),
        bindings_(bindings),
        around_(around) {}

  Scene build();

 private:
  // The data that the instances of one node have in common.
  struct Shared {
    std::uint32_t node = kNone;
    std::uint32_t first_child = 0, end_child = 0;  // in children_
    std::uint32_t content = kNone;                 // a Transform's transform, a Shape's geometry
    std::uint32_t extension = kNone;               // as in Instance
    std::uint32_t name = kNone;                    // number of the name
    std::uint32_t first_instance = kNone;          // the others are its copies; kNone: none is
    NodeKind kind = NodeKind::kGroup;
    bool inner_name = false;
    bool siblings = false;  // two of its children or more have names
  };
  // The presence that the standard gives the children of a node, as Instance has it.
  struct Presence {
    bool collides = true, drawn = true;
    [[nodiscard]] Presence below(Presence parent) const { return {collides && parent.collides, drawn && parent.drawn}; }
    // Returns whether everything present here is present in the instance, so that this can be copied from it.
    [[nodiscard]] bool within(const Instance& i) const { return (!collides || i.collides) && (!drawn || i.drawn); }
  };
  // Children stand in file order, with those that are no instances; the proxy of a Collision stands behind its
  // children.
  struct Child {
    std::uint32_t shared = kNone;  // kNone: it is no instance
    Position at = 0;
    Presence presence{};
  };

  std::uint32_t add_geometry(std::uint32_t node);
  [[nodiscard]] bool takes_heights(std::uint32_t node);
  [[nodiscard]] bool has_room(const Node& node, const Geometry& geometry);
  void share(std::uint32_t node);
  void share_children(const Node& node, Shared& shared);
  void share_transform(const Node& node, Shared& shared);
  void share_shape(const Node& node, Shared& shared);
  CollisionResponse make_response(const Node& node);
  [[nodiscard]] std::uint32_t shared_by(const NodeRef& ref) const {
    return ref.is_node() ? shared_of_[ref.index] : kNone;
  }
  void add_child(const NodeRef& ref, Presence presence) { children_.emplace_back(shared_by(ref), ref.at, presence); }
  bool measure_instances();
  void instantiate(const Child& child, std::int32_t parent, std::uint32_t child_index, Presence presence);
  void copy_instances(std::uint32_t first, std::int32_t parent, std::uint32_t child_index, Presence presence);
  void add_pending_inline(const Node& node, std::uint32_t id);
  void mark_siblings(std::uint32_t parent, std::uint32_t begin, std::uint32_t end);

  const std::shared_ptr<const Document>& document_;
  const std::vector<Node>& nodes_;
  const Tessellation& tessellation_;
  const ReadLimits& limits_;
  Problems& problems_;
  const Bindings* bindings_;  // null: names in it are read
  const Around& around_;
  Scene scene_;
  std::uint64_t swept_polygons_ = 0;        // polygons of the Extrusions and ElevationGrids so far
  std::vector<std::uint32_t> geometry_of_;  // indexed by node
  std::map<std::vector<const void*>, std::uint32_t> copied_geometry_;
  std::optional<std::set<std::uint32_t>> taking_heights_;  // the nodes with a ROUTE to set_height
  std::vector<std::uint32_t> shared_of_;                   // indexed by node, into shared_; kNone: it has no instances
  std::vector<Shared> shared_;
  std::vector<Child> children_;            // children of each Shared, side by side
  NameTable<std::uint32_t> name_numbers_;  // numbers of all names of instances
  std::vector<std::uint32_t>
      first_of_name_;                       // indexed by number, the first instance; kNone: no name of the world's own
  std::vector<std::uint32_t> last_parent_;  // indexed by number, of the instance that was marked last
};

// Adds a geometry, or finds it among copies: copies of the geometry of a PROTO have the same values, not just equal
// ones.
std::uint32_t Builder::add_geometry(std::uint32_t index) {
  const Node& node = nodes_[index];
  std::vector<const void*> key;
  if (node.scope != 0) {
    key.push_back(node.type);
    for (const Field& field : node.given()) {
      if (field.spec->type != FieldType::kSFNode) {
        key.insert(key.end(), {field.spec, field.data});
      } else if (field.spec->name == "coord" && field.count == 1 && field.as<NodeRef>()[0].is_node()) {
        for (const Field& inner : nodes_[field.as<NodeRef>()[0].index].given()) key.push_back(inner.data);
      }
    }
    const auto it = copied_geometry_.find(key);
    if (it != copied_geometry_.end()) return it->second;
  }
  std::optional<Geometry> geometry = read_geometry(document_, node, takes_heights(index), problems_);
  if (!geometry) return kNone;
  if (!has_room(node, *geometry)) return kNone;
  const auto place = static_cast<std::uint32_t>(scene_.geometries.size());
  scene_.geometries.push_back(std::move(*geometry));
  if (!key.empty()) copied_geometry_.emplace(std::move(key), place);
  return place;
}

// Returns whether a ROUTE leads to set_height of the node. The ROUTEs are read once, however many grids there are.
bool Builder::takes_heights(std::uint32_t node) {
  if (nodes_[node].type->name != "ElevationGrid") return false;
  if (!taking_heights_) {
    taking_heights_.emplace();
    for (const Route& route : document_->routes) {
      if (route.to->name == "set_height") taking_heights_->insert(route.to_node);
    }
  }
  return taking_heights_->contains(node);
}

// A short text can ask for a grid or an Extrusion of billions.
bool Builder::has_room(const Node& node, const Geometry& geometry) {
  const std::uint64_t polygons = mesh_size(geometry, tessellation_).polygons;
  const std::string what = "this " + std::string(node.type->name) + " has " + std::to_string(polygons) + " polygons";
  if (polygons > limits_.polygons) {
    problems_.error(node.at,
                    what + ", more than the " + std::to_string(limits_.polygons) + " that one geometry may have");
    return false;
  }
  if (!std::holds_alternative<ExtrusionGeometry>(geometry) && !std::holds_alternative<ElevationGridGeometry>(geometry))
    return true;
  if (bindings_ != nullptr) return true;  // the text that it came with was allowed it
  const std::uint64_t allowed = limits_.swept_polygons(problems_.bytes());
  if (polygons > allowed - swept_polygons_) {
    problems_.error(node.at, what + ", with which Extrusions and ElevationGrids have more than the " +
                                 std::to_string(allowed) + " that " + std::to_string(problems_.bytes()) +
                                 " bytes of text may ask for" + std::string(ReadLimits::kRaised));
    return false;
  }
  swept_polygons_ += polygons;
  return true;
}

CollisionResponse Builder::make_response(const Node& node) {
  CollisionResponse response;
  if (node.type->name != "CollisionResponse") return response;  // an EXTERNPROTO that was not found
  const Field& type = value_of(node, "responseType");
  const std::int32_t written = type.as<std::int32_t>()[0];
  if (written > 2) {
    problems_.error(type.at, "responseType must be 0 (CRT_INVERSE), 1 (CRT_ZERO) or 2 (CRT_IMPULSE), found " +
                                 std::to_string(written));
  }
  response.type = static_cast<ResponseType>(written);
  response.set_back = value_of(node, "setBack").as<bool>()[0];
  const auto number = [&](std::string_view name) { return static_cast<double>(value_of(node, name).as<float>()[0]); };
  response.mass_kg = number("mass");
  response.restitution = number("restitution");
  response.friction_m_s2 = number("friction");
  if (response.restitution > 1.0) {
    problems_.error(value_of(node, "restitution").at, "restitution must be 0 to 1: more would make speed of nothing");
  }
  for (const Field& field : node.given()) {
    const std::string_view name = field.spec->name;
    if (response.type == ResponseType::kImpulse || (name != "mass" && name != "restitution" && name != "friction")) {
      continue;
    }
    problems_.warning(field.at, std::string(name) + " counts with responseType 2 (CRT_IMPULSE) only");
  }
  return response;
}

void Builder::share_transform(const Node& node, Shared& shared) {
  shared.content = static_cast<std::uint32_t>(scene_.transforms.size());
  TransformFields& t = scene_.transforms.emplace_back();
  ObjectFields object;
  bool extended = false;
  for (const Field& field : node.given()) {
    const std::string_view name = field.spec->name;
    if (name == "translation") {
      t.translation = to_vec3(field);
    } else if (name == "rotation") {
      t.rotation = rotation_of(field);
    } else if (name == "scale") {
      t.scale = to_vec3(field);
      // glTF allows what VRML97 does not.
      if (!(t.scale.minCoeff() > 0.0) && problems_.kind_of(field.at) == TextKind::kVrml) {
        problems_.warning(field.at, "a scale of 0 or less is outside VRML97; it is applied as written");
      }
    } else if (name == "scaleOrientation") {
      t.scale_orientation = rotation_of(field);
    } else if (name == "center") {
      t.center = to_vec3(field);
    } else if (name == "velocityVector") {
      object.velocity = to_vec3(field);
      extended = true;
    } else if (name == "distanceThreshold") {
      object.distance_threshold_m = field.as<float>()[0];
      extended = true;
    } else if (name == "enslaved") {
      object.enslaved = field.as<bool>()[0];
      extended = true;
    } else if (name == "remote") {
      object.remote = field.as<bool>()[0];
      extended = true;
    } else if (name == "collisionLayers") {
      object.layers = static_cast<std::uint32_t>(field.as<std::int32_t>()[0]);
      extended = true;
    } else if (name == "collisionResponse" && field.count == 1 && field.as<NodeRef>()[0].is_node()) {
      object.response = make_response(nodes_[field.as<NodeRef>()[0].index]);
      extended = true;
    }
  }
  if (!extended) return;
  shared.extension = static_cast<std::uint32_t>(scene_.object_fields.size());
  scene_.object_fields.push_back(object);
}

void Builder::share_shape(const Node& node, Shared& shared) {
  ShapeFields shape;
  bool extended = false;
  for (const Field& field : node.given()) {
    const std::string_view name = field.spec->name;
    if (name == "geometry") {
      if (field.count == 1 && field.as<NodeRef>()[0].is_node()) {
        shared.content = geometry_of_[field.as<NodeRef>()[0].index];
      }
    } else if (name == "convexHull") {
      shape.convex_hull = {document_, {static_cast<const Eigen::Vector3f*>(field.data), field.count / 3}};
      extended = true;
    } else if (name == "hierarchyFile") {
      shape.hierarchy_file = field.as<std::string_view>()[0];
      extended = true;
    } else if (name == "splitThreshold") {
      shape.split_threshold = field.as<std::int32_t>()[0];
      extended = true;
    }
  }
  if (!extended) return;
  shared.extension = static_cast<std::uint32_t>(scene_.shape_fields.size());
  scene_.shape_fields.push_back(shape);
}

void Builder::share_children(const Node& node, Shared& shared) {
  const auto refs = [&](std::string_view name) {
    const Field* const field = node.find(name);
    return field == nullptr ? std::span<const NodeRef>{} : field->as<NodeRef>();
  };
  shared.first_child = static_cast<std::uint32_t>(children_.size());
  switch (node.type->role) {
    case NodeRole::kShape:
      break;
    case NodeRole::kLod:
      for (const NodeRef& ref : refs("level")) {
        const bool first = children_.size() == shared.first_child;
        add_child(ref, {first, first});
      }
      break;
    case NodeRole::kSwitch: {
      std::int64_t which = value_of(node, "whichChoice").as<std::int32_t>()[0];
      for (const NodeRef& ref : refs("choice")) {
        const bool chosen = which-- == 0;
        add_child(ref, {chosen, chosen});
      }
      break;
    }
    case NodeRole::kCollision: {
      const bool collide = value_of(node, "collide").as<bool>()[0];
      const auto proxy = refs("proxy");
      const bool proxied = !proxy.empty() && proxy[0].is_node();
      for (const NodeRef& ref : refs("children")) add_child(ref, {collide && !proxied, true});
      if (proxied) add_child(proxy[0], {collide, false});
      break;
    }
    default:
      for (const NodeRef& ref : refs("children")) add_child(ref, {});
  }
  shared.end_child = static_cast<std::uint32_t>(children_.size());
}

void Builder::share(std::uint32_t index) {
  const Node& node = nodes_[index];
  shared_of_[index] = static_cast<std::uint32_t>(shared_.size());
  Shared& shared = shared_.emplace_back();
  shared.node = index;
  shared.kind = kind_of(node.type->role);
  shared.inner_name = node.scope != 0;
  if (node.type->role == NodeRole::kTransform) share_transform(node, shared);
  if (node.type->role == NodeRole::kShape) share_shape(node, shared);
  share_children(node, shared);
  if (node.def.empty()) return;
  // A name is looked up once a node, however many instances there are of it.
  const auto next = static_cast<std::uint32_t>(name_numbers_.size());
  std::uint32_t& number = name_numbers_[node.def];
  if (name_numbers_.size() > next) number = next;  // the name was new
  shared.name = number;
}

// Returns whether the scene is small enough to instantiate. Children stand before their parents in the document, so one
// pass knows the instances and height of each node; a chain of USE can be deeper and larger than any text.
bool Builder::measure_instances() {
  std::vector<std::uint32_t> count(shared_.size(), 0);
  std::vector<std::uint16_t> height(shared_.size(), 0);
  const std::size_t errors = problems_.errors();
  bool too_many = false;
  const auto add = [&](const Child& one, std::uint32_t& total) {
    const std::uint64_t sum = std::uint64_t{total} + count[one.shared];
    if (sum > limits_.instances && !std::exchange(too_many, true)) {
      problems_.error(one.at, "with this node there are more than " + std::to_string(limits_.instances) + " instances");
    }
    total = static_cast<std::uint32_t>(std::min<std::uint64_t>(sum, std::uint64_t{limits_.instances} + 1));
  };
  for (std::size_t i = 0; i < shared_.size(); ++i) {
    Shared& shared = shared_[i];
    count[i] = height[i] = 1;
    std::uint32_t named = 0;
    for (std::uint32_t c = shared.first_child; c < shared.end_child; ++c) {
      const Child& one = children_[c];
      if (one.shared == kNone) continue;
      assert(one.shared < i);
      if (height[one.shared] == kMaxNesting && errors == 0) {
        problems_.error(one.at, "instances are nested more than " + std::to_string(kMaxNesting) + " deep here");
      }
      height[i] = std::max<std::uint16_t>(
          height[i], static_cast<std::uint16_t>(std::min<std::uint32_t>(height[one.shared] + 1u, kMaxNesting + 1)));
      add(one, count[i]);
      named += shared_[one.shared].name == kNone ? 0 : 1;
    }
    shared.siblings = named > 1;
  }
  std::uint32_t total = 0;
  for (const NodeRef& ref : document_->top_level) {
    if (const Child one{shared_by(ref), ref.at}; one.shared != kNone) add(one, total);
  }
  if (problems_.errors() != errors) return false;
  scene_.instances.reserve(total);
  first_of_name_.assign(name_numbers_.size(), kNone);
  last_parent_.assign(name_numbers_.size(), kNone);
  return true;
}

void Builder::instantiate(const Child& child, std::int32_t parent, std::uint32_t child_index, Presence presence) {
  if (child.shared == kNone) return;
  Shared& shared = shared_[child.shared];
  presence = child.presence.below(presence);
  if (const std::uint32_t first = shared.first_instance; first != kNone && presence.within(scene_.instances[first])) {
    return copy_instances(first, parent, child_index, presence);
  }
  const auto id = static_cast<std::uint32_t>(scene_.instances.size());
  Instance& instance = scene_.instances.emplace_back();
  if (shared.name != kNone) instance.def = nodes_[shared.node].def;
  instance.parent = parent;
  instance.child_index = child_index;
  instance.node = shared.node;
  if (shared.kind == NodeKind::kTransform) instance.transform = shared.content;
  if (shared.kind == NodeKind::kShape) instance.geometry = shared.content;
  instance.extension = shared.extension;
  instance.kind = shared.kind;
  instance.inner_name = shared.inner_name;
  instance.collides = presence.collides;
  instance.drawn = presence.drawn;
  if (shared.name != kNone && !shared.inner_name && first_of_name_[shared.name] == kNone) {
    first_of_name_[shared.name] = id;
  }
  const std::size_t inlines = scene_.pending_inlines.size();
  for (std::uint32_t c = shared.first_child; c < shared.end_child; ++c) {
    instantiate(children_[c], static_cast<std::int32_t>(id), c - shared.first_child, presence);
  }
  const auto end = static_cast<std::uint32_t>(scene_.instances.size());
  scene_.instances[id].subtree_end = end;
  if (shared.siblings) mark_siblings(id, id + 1, end);
  if (shared.kind == NodeKind::kInline) add_pending_inline(nodes_[shared.node], id);
  // All instances of an Inline that is left for later are pending by themselves.
  if (scene_.pending_inlines.size() == inlines) shared.first_instance = id;
}

// Adds an instance and all below it once more; where this one does not collide or is not drawn, nothing below it does
// or is.
void Builder::copy_instances(std::uint32_t first, std::int32_t parent, std::uint32_t child_index, Presence presence) {
  auto& instances = scene_.instances;
  const auto id = static_cast<std::uint32_t>(instances.size());
  const std::uint32_t end = instances[first].subtree_end, distance = id - first;
  for (std::uint32_t i = first; i < end; ++i) {
    Instance& copy = instances.emplace_back(instances[i]);  // there is room: measure_instances() made it
    copy.parent += static_cast<std::int32_t>(distance);
    copy.subtree_end += distance;
    copy.collides = copy.collides && presence.collides;
    copy.drawn = copy.drawn && presence.drawn;
  }
  instances[id].parent = parent;
  instances[id].child_index = child_index;
  instances[id].name_shadowed = false;
}

void Builder::add_pending_inline(const Node& node, std::uint32_t id) {
  if (node.find(inline_content().name) != nullptr) return;
  const Field* url = node.find("url");
  const Vec3 size = to_vec3(value_of(node, "bboxSize"));
  if (url == nullptr || url->count == 0 || !(size.minCoeff() >= 0.0)) return;
  if (bindings_ != nullptr && !bindings_->bases.contains(scene_.instances[id].node)) return;
  PendingInline& pending = scene_.pending_inlines.emplace_back();
  pending.instance = scene_.id_of(id);
  pending.box_center = to_vec3(value_of(node, "bboxCenter")).cast<float>();
  pending.box_size = size.cast<float>();
  for (const std::string_view one : url->as<std::string_view>()) pending.urls.emplace_back(one);
  pending.base =
      bindings_ != nullptr ? bindings_->bases.at(scene_.instances[id].node) : std::string(problems_.name_of(url->at));
}

// Siblings of one name are found by it only if they are the first. A lone name, at the top level, means the first in
// the world, wherever that is.
void Builder::mark_siblings(std::uint32_t parent, std::uint32_t begin, std::uint32_t end) {
  auto& instances = scene_.instances;
  for (std::uint32_t i = begin; i < end; i = instances[i].subtree_end) {
    const std::uint32_t number = shared_[shared_of_[instances[i].node]].name;
    if (number == kNone) continue;
    const bool elsewhere = parent == kTop && first_of_name_[number] != i;
    if (std::exchange(last_parent_[number], parent) == parent || elsewhere) instances[i].name_shadowed = true;
  }
}

Scene Builder::build() {
  scene_.document = document_;
  scene_.tessellation = tessellation_;
  geometry_of_.assign(nodes_.size(), kNone);
  shared_of_.assign(nodes_.size(), kNone);
  std::size_t transforms = 0, geometries = 0, shared = 0;
  for (const Node& node : nodes_) {
    const NodeRole role = node.type->role;
    transforms += role == NodeRole::kTransform ? 1 : 0;
    geometries += role == NodeRole::kGeometry && node.scope == 0 ? 1 : 0;  // PROTOs share theirs
    shared += is_instance(role) ? 1 : 0;
  }
  scene_.transforms.reserve(transforms);
  scene_.geometries.reserve(geometries);
  shared_.reserve(shared);
  children_.reserve(shared);
  bool scripts = false;
  std::vector<std::uint32_t> with_paths;  // nodes that name instances
  for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
    const Node& node = nodes_[i];
    const NodeRole role = node.type->role;
    if (role == NodeRole::kGeometry) geometry_of_[i] = add_geometry(i);
    if (role == NodeRole::kScript && !std::exchange(scripts, true)) {
      problems_.warning(node.at, "Scripts are kept and not run; this is the first one");
    }
    if (role == NodeRole::kCollisionInterest || role == NodeRole::kKeySensor) with_paths.push_back(i);
    if (is_instance(role)) share(i);
  }
  if (!measure_instances()) return {};
  scene_.ids = bindings_ != nullptr ? bindings_->ids : LastingIds<ObjectId>(around_.first_object);
  for (std::uint32_t i = 0; i < document_->top_level.size(); ++i) {
    instantiate({shared_by(document_->top_level[i])}, -1, i, {});
  }
  mark_siblings(kTop, 0, static_cast<std::uint32_t>(scene_.instances.size()));
  ObjectFinder objects(*document_, scene_, name_numbers_, first_of_name_, problems_, around_);
  InterestReader interests(*document_, scene_, objects, problems_);
  if (bindings_ == nullptr) interests.check_key_routes();
  for (const std::uint32_t i : with_paths) {
    const bool is_interest = nodes_[i].type->role == NodeRole::kCollisionInterest;
    if (bindings_ == nullptr) {
      is_interest ? interests.add_interest(i) : interests.add_key_sensor(i);
    } else if (is_interest) {
      if (const auto bound = bindings_->interests.find(i); bound != bindings_->interests.end()) {
        interests.add_bound_interest(i, bound->second);
      }
    } else if (const auto bound = bindings_->recipients.find(i); bound != bindings_->recipients.end()) {
      interests.add_bound_key_sensor(i, bound->second);
    }
  }
  return std::move(scene_);
}

}  // namespace

Scene build_scene(const std::shared_ptr<const Document>& document, const Tessellation& tessellation,
                  const ReadLimits& limits, Problems& problems, const Around& around) {
  return Builder(document, tessellation, limits, problems, nullptr, around).build();
}

std::expected<Scene, std::string> rebuild_scene(const std::shared_ptr<const Document>& document,
                                                const Tessellation& tessellation, const ReadLimits& limits,
                                                const Bindings& bindings) {
  Problems problems;
  const Around nothing;
  Scene scene = Builder(document, tessellation, limits, problems, &bindings, nothing).build();
  if (problems.errors() > 0) return std::unexpected(problems.first_error());
  return scene;
}

}  // namespace peerd::vrml
