#include "core/vrml/prototype.hpp"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include "core/vrml/element_positions.hpp"

namespace peerd::vrml {
namespace {

// The same nodes, `base` further on.
Field moved(const Field& field, std::uint32_t base, Arena& arena) {
  const std::span<NodeRef> refs = arena.allocate<NodeRef>(field.count);
  std::ranges::transform(field.as<NodeRef>(), refs.begin(), [&](NodeRef ref) {
    if (ref.is_node()) ref.index += base;
    return ref;
  });
  Field out = field;
  out.data = refs.data();
  return out;
}

const Field* find(std::span<const Field> fields, const FieldSpec& spec) {
  const auto it = std::ranges::find(fields, &spec, &Field::spec);
  return it == fields.end() ? nullptr : &*it;
}

}  // namespace

bool check_nodes(const FieldSpec& spec, const Field& value, const std::vector<Node>& nodes, Problems& problems) {
  if (!holds_nodes(spec.type)) return true;
  bool good = true;
  for (const NodeRef& ref : value.as<NodeRef>()) {
    if (!ref.is_node()) continue;
    const NodeType& type = *nodes[ref.index].type;
    if ((spec.accepts & type.classes) != 0) continue;
    std::string message = quoted(spec.name) + " takes " + std::string(name_of_classes(spec.accepts)) + "; " +
                          std::string(type.name) + " is " + std::string(name_of_classes(type.classes));
    if (spec.accepts == kChild) {
      // Shown by nobody and solid to nobody, and harmless.
      if (type.classes == kGeometry) message += ": write Shape { geometry " + std::string(type.name) + " { .. } }";
      problems.warning(ref.at, message + "; here it has no effect");
      continue;
    }
    problems.error(ref.at, message);
    good = false;
  }
  return good;
}

bool check_range(const FieldSpec& spec, const Field& value, Problems& problems) {
  if (spec.range == Range::kAny) return true;
  const bool positive =
      spec.range == Range::kPositive || spec.range == Range::kShouldBePositive || spec.range == Range::kSize;
  const bool must = spec.range == Range::kPositive || spec.range == Range::kNonNegative || spec.range == Range::kSize;
  bool good = true;
  std::optional<ElementPositions> positions;
  const auto check = [&](std::size_t element, double number) {
    if (positive ? number > 0 : number >= 0) return;
    if (problems.full()) return;
    if (!positions) positions.emplace(problems.text_of(value.at), problems.begin_of(value.at), value.at);
    const bool is_error = must && !(spec.range == Range::kSize && number == 0);
    const std::string found = ", found " + quoted(positions->text_at(element));
    const Position at = positions->at(element);
    if (is_error) {
      problems.error(at, quoted(spec.name) + (positive ? " must be > 0" : " must be >= 0") + found);
      good = false;
    } else {
      problems.warning(
          at, quoted(spec.name) + (positive ? " should be > 0" : " should be >= 0") + found + "; it is taken as it is");
    }
  };
  if (float_count(spec.type) > 0) {
    for (std::size_t i = 0; i < value.count; ++i) check(i, static_cast<double>(value.as<float>()[i]));
  } else if (spec.type == FieldType::kSFInt32 || spec.type == FieldType::kMFInt32) {
    for (std::size_t i = 0; i < value.count; ++i) check(i, value.as<std::int32_t>()[i]);
  } else if (spec.type == FieldType::kSFTime || spec.type == FieldType::kMFTime) {
    for (std::size_t i = 0; i < value.count; ++i) check(i, value.as<double>()[i]);
  }
  return good;
}

NodeSet reach(const Body& body, std::uint32_t node) {
  NodeSet set;
  std::unordered_set<std::uint32_t> seen = {node};
  std::vector<std::uint32_t> open = {node};
  while (!open.empty()) {
    const std::uint32_t at = open.back();
    open.pop_back();
    set.nodes.push_back(at);
    for (const Field& field : body.nodes[at].given()) {
      if (!holds_nodes(field.spec->type)) continue;
      set.references += field.count;
      for (const NodeRef& ref : field.as<NodeRef>()) {
        // A Script's view of what is around it is not copied with it.
        if (ref.is_node() && ref.index < at && seen.insert(ref.index).second) open.push_back(ref.index);
      }
    }
  }
  std::ranges::sort(set.nodes);  // a node stands behind all that it refers to
  return set;
}

std::uint32_t copy_nodes(const Body& from, const NodeSet& set, Body& to, Arena& arena) {
  std::unordered_map<std::uint32_t, std::uint32_t> place;
  for (const std::uint32_t node : set.nodes) {
    Node copy = from.nodes[node];
    const std::span<Field> fields = arena.allocate<Field>(copy.field_count);
    std::ranges::transform(copy.given(), fields.begin(), [&](Field field) {
      if (!holds_nodes(field.spec->type)) return field;
      const std::span<NodeRef> refs = arena.allocate<NodeRef>(field.count);
      std::ranges::transform(field.as<NodeRef>(), refs.begin(), [&](NodeRef ref) {
        const auto it = place.find(ref.index);
        ref.index = it == place.end() ? NodeRef::kNull : it->second;
        return ref;
      });
      field.data = refs.data();
      return field;
    });
    copy.fields = fields.data();
    place[node] = static_cast<std::uint32_t>(to.nodes.size());
    to.nodes.push_back(copy);
  }
  to.references += set.references;
  return place.at(set.nodes.back());
}

Expansion expand(const Prototype& prototype, std::span<const Field> given, Body& out, Arena& arena,
                 Problems& problems) {
  const auto base = static_cast<std::uint32_t>(out.nodes.size());
  const Body& body = prototype.body;
  // Links by node, so that one pass over the nodes serves them all.
  std::vector<const IsLink*> links;
  for (const IsLink& link : prototype.links) {
    if (has_value(link.outer->access) && has_value(link.inner->access)) links.push_back(&link);
  }
  std::ranges::stable_sort(links, {}, &IsLink::node);
  auto link = links.begin();
  // Defaults as they stand in this copy, each made once however many fields take it.
  std::vector<std::optional<Field>> defaults(prototype.defaults.size());
  const auto default_of = [&](const FieldSpec& outer) -> const std::optional<Field>& {
    const auto i = static_cast<std::size_t>(&outer - prototype.type.fields.data());
    if (!defaults[i] && prototype.defaults[i]) {
      defaults[i] = prototype.defaults[i];
      if (holds_nodes(outer.type)) defaults[i] = moved(*defaults[i], base, arena);
    }
    return defaults[i];
  };
  std::vector<Field> fields;
  for (std::uint32_t i = 0; i < body.nodes.size(); ++i) {
    Node node = body.nodes[i];
    node.scope += out.scopes;
    const bool linked = link != links.end() && (*link)->node == i;
    const bool refers = std::ranges::any_of(node.given(), [](const Field& f) { return holds_nodes(f.spec->type); });
    if (linked || refers) {
      fields.assign(node.given().begin(), node.given().end());
      for (Field& field : fields) {
        if (holds_nodes(field.spec->type)) field = moved(field, base, arena);
      }
      for (; link != links.end() && (*link)->node == i; ++link) {
        const FieldSpec& inner = *(*link)->inner;
        const Field* value = find(given, *(*link)->outer);
        const std::optional<Field>& otherwise = default_of(*(*link)->outer);
        if (value == nullptr && !otherwise) {
          node.damaged = true;
          continue;
        }
        Field field = value != nullptr ? *value : *otherwise;
        field.spec = &inner;
        // Defaults were checked with the PROTO; what an instance gives is its own.
        const bool good =
            value == nullptr || (check_nodes(inner, field, out.nodes, problems) & check_range(inner, field, problems));
        std::erase_if(fields, [&](const Field& f) { return f.spec == &inner; });
        if (good) fields.push_back(field);
        node.damaged |= !good;
      }
      const auto copy = arena.copy(std::span<const Field>(fields));
      node.fields = copy.data();
      node.field_count = static_cast<std::uint32_t>(copy.size());
    }
    out.nodes.push_back(node);
  }
  for (Route route : body.routes) {
    route.from_node += base;
    route.to_node += base;
    out.routes.push_back(route);
  }
  for (InnerName name : body.inner_names) {
    name.scope += out.scopes;
    name.node += base;
    out.inner_names.push_back(name);
  }
  out.references += body.references;
  out.scopes += body.scopes;
  std::uint32_t root = NodeRef::kNull;
  if (!body.roots.empty() && body.roots.front().is_node()) root = body.roots.front().index + base;
  return {root, base};
}

}  // namespace peerd::vrml
