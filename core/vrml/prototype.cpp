#include "core/vrml/prototype.hpp"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include "core/vrml/field_checks.hpp"

namespace peerd::vrml {
namespace {

// Returns a field with the same nodes, `base` further on.
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

// Sorts links, which are in order already in most files, or nearly so.
template <class Link, class Key>
void sort_by(std::vector<Link>& links, Key Link::*key) {
  if (!std::ranges::is_sorted(links, {}, key)) std::ranges::stable_sort(links, {}, key);
}

bool refers(const Node& node) {
  return std::ranges::any_of(node.given(), [](const Field& f) { return holds_nodes(f.spec->type); });
}

std::size_t place_of(const Prototype& prototype, const FieldSpec& outer) {
  return static_cast<std::size_t>(&outer - prototype.type.fields.data());
}

}  // namespace

NodeSet reachable_nodes(const Body& body, std::uint32_t node) {
  NodeSet set;
  std::unordered_set<std::uint32_t> seen = {node};
  std::vector<std::uint32_t> open = {node};
  while (!open.empty()) {
    const std::uint32_t at = open.back();
    open.pop_back();
    set.nodes.push_back(at);
    set.cost += cost_of_fields(body.nodes[at].field_count);
    for (const Field& field : body.nodes[at].given()) {
      if (!holds_nodes(field.spec->type)) continue;
      set.references += field.count;
      for (const NodeRef& ref : field.as<NodeRef>()) {
        // The nodes around a Script that its fields refer to are not copied with it.
        if (ref.is_node() && ref.index < at && seen.insert(ref.index).second) open.push_back(ref.index);
      }
    }
  }
  set.cost += set.references;
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

void sort_links(Prototype& prototype) {
  prototype.value_of_field.assign(prototype.type.fields.size(), ValueLink::kNone);
  for (const IsLink& link : prototype.links) {
    // The inner field sends events where the outer one does, and likewise takes them (table 4.4).
    if (link.outer->access != Access::kField && link.inner->access != Access::kField) {
      prototype.event_links.push_back(link);
    }
    if (!has_value(link.outer->access) || !has_value(link.inner->access)) continue;
    const std::size_t place = place_of(prototype, *link.outer);
    std::uint32_t& number = prototype.value_of_field[place];
    if (number == ValueLink::kNone) {
      number = static_cast<std::uint32_t>(prototype.linked_fields.size());
      prototype.linked_fields.push_back(static_cast<std::uint32_t>(place));
      prototype.link_counts.push_back(0);
    }
    ++prototype.link_counts[number];
    prototype.value_links.push_back({.node = link.node, .value = number, .inner = link.inner});
  }
  sort_by(prototype.links, &IsLink::outer);
  sort_by(prototype.event_links, &IsLink::outer);
  sort_by(prototype.value_links, &ValueLink::node);
  std::unordered_map<const FieldSpec*, std::uint32_t> of_node;
  auto link = prototype.value_links.begin();
  for (std::uint32_t i = 0; i < prototype.body.nodes.size(); ++i) {
    const Node& node = prototype.body.nodes[i];
    const auto first = link;
    of_node.clear();
    for (; link != prototype.value_links.end() && link->node == i; ++link) {
      const auto [it, is_new] = of_node.try_emplace(link->inner, static_cast<std::uint32_t>(of_node.size()));
      link->field = it->second;
      const auto own = is_new ? std::ranges::find(node.given(), link->inner, &Field::spec) : node.given().end();
      if (own != node.given().end()) link->replaces = static_cast<std::uint32_t>(own - node.given().begin());
    }
    const auto links = static_cast<std::uint64_t>(link - first);
    if (links > 0 || refers(node)) prototype.copied_references += cost_of_fields(node.field_count + links);
  }
}

std::span<const IsLink> links_of(const std::vector<IsLink>& by_outer, const FieldSpec& outer) {
  return std::ranges::equal_range(by_outer, &outer, {}, &IsLink::outer);
}

std::span<const ValueLink> value_links_of(const Prototype& prototype, std::uint32_t node) {
  return std::ranges::equal_range(prototype.value_links, node, {}, &ValueLink::node);
}

std::vector<const Field*> linked_values(const Prototype& prototype, std::span<const Field> given) {
  std::vector<const Field*> values(prototype.linked_fields.size(), nullptr);
  if (values.empty()) return values;
  for (const Field& field : given) {
    const std::uint32_t value = prototype.value_of_field[place_of(prototype, *field.spec)];
    if (value != ValueLink::kNone) values[value] = &field;
  }
  return values;
}

std::uint64_t cost_of_values(const Prototype& prototype, std::span<const Field> given) {
  const std::vector<const Field*> values = linked_values(prototype, given);
  std::uint64_t cost = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::uint64_t links = prototype.link_counts[i];
    const FieldSpec& outer = prototype.type.fields[prototype.linked_fields[i]];
    const std::optional<Field>& otherwise = prototype.defaults[prototype.linked_fields[i]];
    const std::uint64_t count = values[i] != nullptr ? values[i]->count : otherwise ? otherwise->count : 0;
    if (holds_nodes(outer.type)) cost += links * count;
    if (!holds_nodes(outer.type) && is_list(outer.type) && values[i] != nullptr) cost += (links - 1) * count;
  }
  return cost;
}

Expansion expand(const Prototype& prototype, std::span<const Field> given, Body& out, Arena& arena,
                 Problems& problems) {
  const auto base = static_cast<std::uint32_t>(out.nodes.size());
  const Body& body = prototype.body;
  const std::vector<const Field*> values = linked_values(prototype, given);
  // The defaults as they stand in this copy, each made once however many fields take it.
  std::vector<std::optional<Field>> defaults(values.size());
  const auto default_of = [&](std::uint32_t value) -> const std::optional<Field>& {
    const std::optional<Field>& original = prototype.defaults[prototype.linked_fields[value]];
    if (!defaults[value] && original) {
      defaults[value] = holds_nodes(original->spec->type) ? moved(*original, base, arena) : *original;
    }
    return defaults[value];
  };
  auto link = prototype.value_links.begin();
  std::vector<Field> fields;
  std::vector<std::uint32_t> places;  // indexed by ValueLink::field: where its value stands among them
  for (std::uint32_t i = 0; i < body.nodes.size(); ++i) {
    Node node = body.nodes[i];
    node.scope += out.scopes;
    const bool linked = link != prototype.value_links.end() && link->node == i;
    if (linked || refers(node)) {
      fields.assign(node.given().begin(), node.given().end());
      for (Field& field : fields) {
        if (holds_nodes(field.spec->type)) field = moved(field, base, arena);
      }
      places.clear();
      for (; link != prototype.value_links.end() && link->node == i; ++link) {
        if (link->field == places.size()) places.push_back(link->replaces);
        const Field* value = values[link->value];
        const std::optional<Field>& otherwise = default_of(link->value);
        if (value == nullptr && !otherwise) {
          node.damaged = true;
          continue;
        }
        Field field = value != nullptr ? *value : *otherwise;
        field.spec = link->inner;
        // Defaults were checked with the PROTO; the values of an instance are its own.
        const bool good = value == nullptr || (check_nodes(*link->inner, field, out.nodes, problems) &
                                               check_range(*link->inner, field, problems));
        std::uint32_t& place = places[link->field];
        if (place != ValueLink::kNone) fields[place].spec = nullptr;
        place = good ? static_cast<std::uint32_t>(fields.size()) : ValueLink::kNone;
        if (good) fields.push_back(field);
        if (good && holds_nodes(field.spec->type)) out.references += field.count;
        node.damaged |= !good;
      }
      if (linked) std::erase_if(fields, [](const Field& f) { return f.spec == nullptr; });
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
