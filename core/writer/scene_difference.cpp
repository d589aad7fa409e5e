#include "core/writer/scene_difference.hpp"

#include <algorithm>
#include <cstring>
#include <tuple>
#include <unordered_set>

#include "core/writer/write_plan.hpp"

namespace peerd {
namespace {

using namespace vrml;

std::string quoted_name(const Node& node) {
  return std::string(node.type->name) + (node.def.empty() ? "" : " " + std::string(node.def));
}

// Returns whether the name is NAME or NAME_2.
bool is_renamed(std::string_view name, std::string_view original) {
  return name.starts_with(original) && (name.size() == original.size() || name[original.size()] == '_');
}

bool is_path(const Node& node, const FieldSpec& spec) {
  const bool has_paths = node.type->role == NodeRole::kCollisionInterest || node.type->role == NodeRole::kKeySensor;
  return has_paths && (spec.type == FieldType::kSFString || spec.type == FieldType::kMFString);
}

bool is_placeholder(const Node& node) { return node.type->name == kPlaceholderType && node.given().empty(); }

std::size_t element_size(FieldType type) {
  switch (type) {
    case FieldType::kSFBool:
      return sizeof(bool);
    case FieldType::kSFTime:
    case FieldType::kMFTime:
      return sizeof(double);
    default:
      return 4;
  }
}

bool same_values(const Field& a, const Field& b) {
  if (a.count != b.count) return false;
  if (a.spec->type == FieldType::kSFString || a.spec->type == FieldType::kMFString) {
    return std::ranges::equal(a.as<std::string_view>(), b.as<std::string_view>());
  }
  return a.count == 0 || std::memcmp(a.data, b.data, a.count * element_size(a.spec->type)) == 0;
}

template <class Vector>
bool same_bytes(const Vector& a, const Vector& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;  // NOLINT(bugprone-suspicious-memory-comparison): -0 differs from 0
}

// Comparison walks two documents, node by node as they are met from the top level, from the nodes outside of it, and
// from each other.
class Comparison {
 public:
  Comparison(const Scene& a, const Scene& b)
      : scene_a_(a),
        scene_b_(b),
        a_(*a.document),
        b_(*b.document),
        paths_a_(a),
        paths_b_(b),
        partner_(a_.nodes.size(), Instance::kNone),
        partner_of_b_(b_.nodes.size(), Instance::kNone) {
    for (const Node& node : b_.nodes) names_b_.insert(node.def);
  }

  std::string run() {
    if (compare_documents() && compare_routes() && compare_instances() && compare_interests()) compare_key_sensors();
    return std::move(found_);
  }

 private:
  bool differs(std::string what) {
    found_ = std::move(what);
    return false;
  }
  bool compare_documents();
  OutsideNodes outside(const Scene& scene, const PathRewriter& paths, std::size_t common) const;
  bool pair(const NodeRef& a, const NodeRef& b, const std::string& where);
  bool pair_lists(const Node& node, const Field& a, const Field& b);
  bool drain();
  bool compare_nodes(std::uint32_t a, std::uint32_t b);
  bool compare_types(const Node& a, const Node& b);
  bool compare_routes();
  bool compare_instances();
  bool compare_instance(std::uint32_t i);
  bool compare_interests();
  bool compare_key_sensors();

  const Scene &scene_a_, &scene_b_;
  const Document &a_, &b_;
  PathRewriter paths_a_, paths_b_;
  std::vector<std::uint32_t> partner_, partner_of_b_;
  std::unordered_set<std::string_view> names_b_;
  std::vector<std::uint32_t> waiting_;  // nodes of a_ that have a partner and are not compared yet
  std::string found_;
};

// The comparison goes on beyond the top level that both have: with the nodes that the writer puts behind it, or would.
OutsideNodes Comparison::outside(const Scene& scene, const PathRewriter& paths, std::size_t common) const {
  const Document& document = *scene.document;
  OutsideNodes out;
  for (std::size_t i = common; i < document.top_level.size(); ++i) {
    const NodeRef& ref = document.top_level[i];
    if (!ref.is_node()) continue;
    const Field* held = document.nodes[ref.index].find(kHolderField);
    if (held == nullptr) {
      out.plain.push_back(ref.index);
      continue;
    }
    for (const NodeRef& node : held->as<NodeRef>()) {
      if (node.is_node()) out.held.push_back(node.index);
    }
  }
  const OutsideNodes more = outside_nodes(document, paths);
  out.plain.insert(out.plain.end(), more.plain.begin(), more.plain.end());
  out.held.insert(out.held.end(), more.held.begin(), more.held.end());
  return out;
}

bool Comparison::compare_documents() {
  const std::size_t common = std::min(a_.top_level.size(), b_.top_level.size());
  for (std::size_t i = 0; i < common; ++i) {
    if (!pair(a_.top_level[i], b_.top_level[i], "node " + std::to_string(i) + " at the top level")) return false;
  }
  const OutsideNodes outside_a = outside(scene_a_, paths_a_, common), outside_b = outside(scene_b_, paths_b_, common);
  for (const auto list : {&OutsideNodes::plain, &OutsideNodes::held}) {
    const auto &x = outside_a.*list, &y = outside_b.*list;
    for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
      if (!pair({x[i]}, {y[i]}, "node " + std::to_string(i) + " behind the scene")) return false;
    }
    if (x.size() != y.size()) {
      return differs("nodes that stand behind the scene: " + std::to_string(x.size()) + ", not " +
                     std::to_string(y.size()));
    }
  }
  return drain();
}

bool Comparison::pair(const NodeRef& a, const NodeRef& b, const std::string& where) {
  if (!a.is_node() || (b.is_node() && is_placeholder(b_.nodes[b.index]) && paths_a_.has_no_target(a_.nodes[a.index]))) {
    return !b.is_node() || is_placeholder(b_.nodes[b.index]) || differs(where + " is null in the first only");
  }
  if (!b.is_node()) return differs(where + " is null in the second only");
  std::uint32_t& partner = partner_[a.index];
  if (partner == Instance::kNone && partner_of_b_[b.index] == Instance::kNone) {
    partner = b.index;
    partner_of_b_[b.index] = a.index;
    waiting_.push_back(a.index);
  }
  return partner == b.index ||
         differs(where + ": " + quoted_name(a_.nodes[a.index]) + " is shared in one of them only");
}

bool Comparison::pair_lists(const Node& node, const Field& a, const Field& b) {
  const std::string where = "field " + std::string(a.spec->name) + " of " + quoted_name(node);
  const auto x = a.as<NodeRef>(), y = b.as<NodeRef>();
  if (a.spec->type == FieldType::kSFNode)
    return pair(x.empty() ? NodeRef{} : x[0], y.empty() ? NodeRef{} : y[0], where);
  if (x.size() != y.size()) {
    return differs(where + ": " + std::to_string(x.size()) + " nodes, not " + std::to_string(y.size()));
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!pair(x[i], y[i], where)) return false;
  }
  return true;
}

bool Comparison::drain() {
  while (!waiting_.empty()) {
    const std::uint32_t a = waiting_.back();
    waiting_.pop_back();
    if (!compare_nodes(a, partner_[a])) return false;
  }
  return true;
}

bool Comparison::compare_types(const Node& a, const Node& b) {
  if (is_filled_inline(a) && b.type->name == "Group") return true;
  const bool external = find_node_type(a.type->name) == nullptr;
  if (a.type->role != b.type->role ||
      !(external ? is_renamed(b.type->name, a.type->name) : a.type->name == b.type->name)) {
    return differs(quoted_name(a) + " is a " + std::string(b.type->name));
  }
  const auto same = [](const FieldSpec& x, const FieldSpec& y) {
    return x.name == y.name && x.type == y.type && x.access == y.access;
  };
  return a.type == b.type || std::ranges::equal(a.type->fields, b.type->fields, same) ||
         differs(quoted_name(a) + " declares other fields");
}

bool Comparison::compare_nodes(std::uint32_t index_a, std::uint32_t index_b) {
  const Node &a = a_.nodes[index_a], &b = b_.nodes[index_b];
  if (!compare_types(a, b)) return false;
  const bool may_rename = (a.scope != 0 && b.scope == 0) || names_b_.contains(a.def);
  const bool same_name = may_rename ? is_renamed(b.def, a.def) : a.def == b.def;
  if (!a.def.empty() && !same_name) return differs(quoted_name(a) + " is named '" + std::string(b.def) + "'");
  const bool as_group = is_filled_inline(a) && b.type->name == "Group";
  std::size_t fields = 0, fields_b = 0;
  for (const Field& field : b.given()) fields_b += is_path(b, *field.spec) ? 0 : 1;
  for (const Field& field : a.given()) {
    if (is_path(a, *field.spec) || (as_group && field.spec->name == "url")) continue;
    ++fields;
    const Field* other = b.find(field.spec->access == Access::kContent && as_group ? "children" : field.spec->name);
    if (other == nullptr) return differs(quoted_name(a) + " has no " + std::string(field.spec->name));
    if (holds_nodes(field.spec->type)) {
      if (!pair_lists(a, field, *other)) return false;
    } else if (!same_values(field, *other)) {
      return differs("field " + std::string(field.spec->name) + " of " + quoted_name(a) + " has another value");
    }
  }
  return fields == fields_b || differs(quoted_name(a) + " has fields that it did not have");
}

bool Comparison::compare_routes() {
  using Ends = std::tuple<std::uint32_t, std::string_view, std::uint32_t, std::string_view>;
  std::vector<Ends> x, y;
  for (const Route& route : a_.routes) {
    const auto lost = [&](std::uint32_t node, const FieldSpec* field) {
      const std::uint32_t other = partner_[node];
      return other != Instance::kNone && field->name == "url" && is_filled_inline(a_.nodes[node]) &&
             b_.nodes[other].type->name == "Group";
    };
    if (lost(route.from_node, route.from) || lost(route.to_node, route.to)) continue;
    x.emplace_back(partner_[route.from_node], route.from->name, partner_[route.to_node], route.to->name);
  }
  for (const Route& route : b_.routes) y.emplace_back(route.from_node, route.from->name, route.to_node, route.to->name);
  std::ranges::sort(x);
  std::ranges::sort(y);
  if (x == y) return true;
  if (x.size() != y.size()) {
    return differs("ROUTEs: " + std::to_string(x.size()) + ", not " + std::to_string(y.size()));
  }
  const auto [mine, theirs] = std::ranges::mismatch(x, y);
  return differs("a ROUTE from " + std::string(std::get<1>(*theirs)) + " to " + std::string(std::get<3>(*theirs)) +
                 " is not the first's");
}

bool Comparison::compare_instance(std::uint32_t i) {
  const Instance &a = scene_a_.instances[i], &b = scene_b_.instances[i];
  const ObjectId id_a = scene_a_.id_of(i), id_b = scene_b_.id_of(i);
  if (partner_[a.node] != b.node) return differs("it is another node");
  const bool as_group = a.kind == NodeKind::kInline && b.kind == NodeKind::kGroup && is_filled_inline(a_.nodes[a.node]);
  if (a.kind != b.kind && !as_group) return differs("its kind");
  if (a.parent != b.parent || a.child_index != b.child_index || a.subtree_end != b.subtree_end)
    return differs("its place");
  if (a.collides != b.collides) return differs("whether it collides");
  if (a.drawn != b.drawn) return differs("whether it is drawn");
  const TransformFields &t = scene_a_.transform(id_a), &u = scene_b_.transform(id_b);
  if (!same_bytes(t.translation, u.translation) || !same_bytes(t.rotation, u.rotation) ||
      !same_bytes(t.scale, u.scale) || !same_bytes(t.scale_orientation, u.scale_orientation) ||
      !same_bytes(t.center, u.center)) {
    return differs("its transform");
  }
  const ObjectFields &o = scene_a_.object(id_a), &p = scene_b_.object(id_b);
  const auto response = [](const ObjectFields& f) {
    const CollisionResponse r = f.response.value_or(CollisionResponse{});
    return std::tuple(f.response.has_value(), r.type, r.set_back, r.mass_kg, r.restitution, r.friction_m_s2);
  };
  if (!same_bytes(o.velocity, p.velocity) || !same_bytes(o.distance_threshold_m, p.distance_threshold_m) ||
      o.enslaved != p.enslaved || o.remote != p.remote || o.layers != p.layers || response(o) != response(p)) {
    return differs("its velocity, threshold, owner, display, layers or response");
  }
  const ShapeFields &s = scene_a_.shape(id_a), &q = scene_b_.shape(id_b);
  const auto same_point = [](const Eigen::Vector3f& x, const Eigen::Vector3f& y) { return same_bytes(x, y); };
  if (s.hierarchy_file != q.hierarchy_file || s.split_threshold != q.split_threshold ||
      !std::ranges::equal(s.convex_hull.span(), q.convex_hull.span(), same_point)) {
    return differs("its hull or hierarchy");
  }
  const Geometry *g = scene_a_.geometry(id_a), *h = scene_b_.geometry(id_b);
  if ((g == nullptr) != (h == nullptr) || (g != nullptr && g->index() != h->index())) return differs("its geometry");
  return true;  // a geometry is its node's fields, which are compared
}

bool Comparison::compare_instances() {
  if (scene_a_.instances.size() != scene_b_.instances.size()) {
    return differs("instances: " + std::to_string(scene_a_.instances.size()) + ", not " +
                   std::to_string(scene_b_.instances.size()));
  }
  for (std::uint32_t i = 0; i < scene_a_.instances.size(); ++i) {
    if (!compare_instance(i)) return differs(scene_a_.path_of(scene_a_.id_of(i)) + " differs: " + found_);
  }
  const auto pending = [](const Scene& scene) {
    std::vector<std::uint32_t> out;
    for (const PendingInline& p : scene.pending_inlines) {
      if (!is_filled_inline(scene.document->nodes[scene.at(p.instance).node]))
        out.push_back(scene.index_of(p.instance));
    }
    return out;
  };
  return pending(scene_a_) == pending(scene_b_) || differs("the Inlines that are read later");
}

bool Comparison::compare_interests() {
  using Row = std::tuple<std::vector<std::uint32_t>, CollisionType, std::vector<std::uint32_t>>;
  const auto rows = [](const Scene& scene) {
    const auto places_of = [&](const InterestSide& side) {
      std::vector<std::uint32_t> places;
      for (const ObjectId end : side.ends) places.push_back(scene.index_of(end));
      return places;
    };
    std::vector<Row> out;
    for (const CollisionInterest& i : scene.interests) {
      out.emplace_back(places_of(i.colliders), i.type, places_of(i.collidees));
    }
    std::ranges::sort(out);
    return out;
  };
  return rows(scene_a_) == rows(scene_b_) || differs("CollisionInterests name other objects");
}

bool Comparison::compare_key_sensors() {
  const auto rows = [&](const Scene& scene, bool first) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> out;  // all else is their nodes' fields
    for (const KeySensor& k : scene.key_sensors) {
      out.emplace_back(first ? partner_[k.node] : k.node, k.recipient ? scene.index_of(*k.recipient) : Instance::kNone);
    }
    std::ranges::sort(out);
    return out;
  };
  return rows(scene_a_, true) == rows(scene_b_, false) || differs("KeySensors move other objects");
}

}  // namespace

std::string difference(const Scene& original, const Scene& copy) { return Comparison(original, copy).run(); }

}  // namespace peerd
