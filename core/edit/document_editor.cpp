#include "core/edit/document_editor.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <set>
#include <string>

namespace peerd::vrml {
namespace {

constexpr std::uint32_t kNull = NodeRef::kNull;

// A Script may name nodes around it and itself, and is no way to any.
bool leads_on(const Node& node) { return node.type->role != NodeRole::kScript; }

template <class T>
const void* copied(Arena& arena, const Field& field) {
  return arena.copy(field.as<T>()).data();
}

const void* copied_strings(Arena& arena, std::span<const std::string_view> strings) {
  const auto out = arena.allocate<std::string_view>(strings.size());
  for (std::size_t i = 0; i < strings.size(); ++i) out[i] = arena.copy(strings[i]);
  return out.data();
}

const void* copied_value(Arena& arena, const Field& field) {
  switch (field.spec->type) {
    case FieldType::kSFBool:
      return copied<bool>(arena, field);
    case FieldType::kSFInt32:
    case FieldType::kMFInt32:
    case FieldType::kSFImage:
      return copied<std::int32_t>(arena, field);
    case FieldType::kSFTime:
    case FieldType::kMFTime:
      return copied<double>(arena, field);
    case FieldType::kSFString:
    case FieldType::kMFString:
      return copied_strings(arena, field.as<std::string_view>());
    case FieldType::kSFNode:
    case FieldType::kMFNode:
      assert(false && "they are written with their new indices");
      return nullptr;
    default:
      return copied<float>(arena, field);
  }
}

void set_field(Document& document, std::uint32_t node, const Field& value) {
  Node& n = document.nodes[node];
  std::vector<Field> fields(n.given().begin(), n.given().end());
  const auto known = std::ranges::find(fields, value.spec, &Field::spec);
  known == fields.end() ? fields.push_back(value) : void(*known = value);
  n.fields = document.arena.copy(std::span<const Field>(fields)).data();
  n.field_count = static_cast<std::uint32_t>(fields.size());
}

}  // namespace

DocumentEditor::DocumentEditor(std::shared_ptr<const Document> document)
    : nodes_(document->nodes),
      top_level_(document->top_level),
      routes_(document->routes),
      inner_names_(document->inner_names) {
  ids_.reserve(nodes_.size());
  for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
    ids_.push_back(document->ids.id_of(i));
    scopes_ = std::max(scopes_, nodes_[i].scope);
  }
  for (const InnerName& inner : inner_names_) scopes_ = std::max(scopes_, inner.scope);
  for (const auto& [node, spec] : document->set_values) {
    const auto given = nodes_[node].given();
    set_.emplace(std::pair(node, spec), *std::ranges::find(given, spec, &Field::spec));
  }
  mark_outside(0, top_level_);
  // An edited document is kept while it is edited, and its texts for as long as a node is of them.
  if (document->sources.empty()) {
    sources_.push_back(std::move(document));
  } else {
    sources_ = document->sources;
    sources_.push_back(std::move(document));
  }
}

std::uint32_t DocumentEditor::append(std::shared_ptr<const Document> text, NodeId first) {
  assert(text->sources.empty() && "it was read");
  const std::uint32_t begin = node_count(), scope = scopes_, source = static_cast<std::uint32_t>(sources_.size());
  const auto moved = [&](std::uint32_t node) { return node == kNull ? kNull : node + begin; };
  for (std::uint32_t i = 0; i < text->nodes.size(); ++i) {
    Node& node = nodes_.emplace_back(text->nodes[i]);
    node.source = source;
    if (node.scope != 0) node.scope += scope;
    scopes_ = std::max(scopes_, node.scope);
    ids_.emplace_back(first.number + i, first.origin);
    for (const Field& field : node.given()) {
      if (!holds_nodes(field.spec->type)) continue;
      std::vector<NodeRef>& refs = lists_[{begin + i, field.spec}];
      for (const NodeRef& ref : field.as<NodeRef>()) refs.push_back({moved(ref.index), ref.at});
    }
  }
  for (Route route : text->routes) {
    route.from_node += begin;
    route.to_node += begin;
    routes_.push_back(route);
  }
  for (const InnerName& inner : text->inner_names) {
    inner_names_.push_back(InnerName{inner.scope + scope, inner.name, inner.node + begin});
    scopes_ = std::max(scopes_, inner.scope + scope);
  }
  std::vector<NodeRef> roots;
  for (const NodeRef& ref : text->top_level) roots.push_back({moved(ref.index), ref.at});
  mark_outside(begin, roots);
  sources_.push_back(std::move(text));
  return begin;
}

void DocumentEditor::mark_outside(std::uint32_t begin, std::span<const NodeRef> top_level) {
  is_outside_.resize(nodes_.size(), true);
  std::vector<std::uint32_t> open;
  const auto reach = [&](const NodeRef& ref) {
    if (!ref.is_node() || !is_outside_[ref.index]) return;
    is_outside_[ref.index] = false;
    open.push_back(ref.index);
  };
  for (const NodeRef& ref : top_level) reach(ref);
  while (!open.empty()) {
    const std::uint32_t node = open.back();
    open.pop_back();
    assert(node >= begin);
    if (!leads_on(nodes_[node])) continue;
    for (const Field& field : nodes_[node].given()) {
      if (holds_nodes(field.spec->type)) std::ranges::for_each(refs_of(node, field), reach);
    }
  }
}

std::span<const NodeRef> DocumentEditor::refs_of(std::uint32_t node, const Field& field) const {
  const auto changed = lists_.find({node, field.spec});
  return changed == lists_.end() ? field.as<NodeRef>() : std::span<const NodeRef>(changed->second);
}

std::vector<NodeRef>& DocumentEditor::list(std::uint32_t node, const FieldSpec& field) {
  assert(holds_nodes(field.type));
  const auto [list, is_new] = lists_.try_emplace({node, &field});
  if (!is_new) return list->second;
  const auto given = nodes_[node].given();
  const auto value = std::ranges::find(given, &field, &Field::spec);
  if (value == given.end()) {
    set_[{node, &field}] = Field{&field, nullptr, 0, nodes_[node].at};
  } else {
    list->second.assign(value->as<NodeRef>().begin(), value->as<NodeRef>().end());
  }
  return list->second;
}

void DocumentEditor::set(std::uint32_t node, const Field& value) {
  assert(!holds_nodes(value.spec->type));
  Field& set = set_[{node, value.spec}] = value;
  set.data = copied_value(values_, value);
}

void DocumentEditor::drop(std::span<const std::uint32_t> nodes) {
  if (nodes.empty()) return;
  const auto dropped = [&](const NodeRef& ref) { return std::ranges::binary_search(nodes, ref.index); };
  for (const std::uint32_t node : nodes) is_outside_[node] = false;
  std::erase_if(top_level_, dropped);
  for (auto& [place, list] : lists_) std::erase_if(list, dropped);
  for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
    for (const Field& field : nodes_[i].given()) {
      if (!holds_nodes(field.spec->type) || std::ranges::none_of(refs_of(i, field), dropped)) continue;
      std::erase_if(list(i, *field.spec), dropped);
    }
  }
}

// The fields of a node: those that it has, in their order, and those that were set, each before the first that its type
// declares later, so that the order does not depend on which was set first.
std::vector<Field> DocumentEditor::fields_of(std::uint32_t node) const {
  const auto given = nodes_[node].given();
  std::vector<Field> fields(given.begin(), given.end());
  for (auto set = set_.lower_bound({node, nullptr}); set != set_.end() && set->first.first == node; ++set) {
    const auto known = std::ranges::find(fields, set->first.second, &Field::spec);
    if (known != fields.end()) {
      *known = set->second;
    } else {
      const auto later = std::ranges::find_if(fields, [&](const Field& f) { return f.spec > set->first.second; });
      fields.insert(later, set->second);
    }
  }
  return fields;
}

// Orders a node behind what it refers to. The recursion is as deep as nodes are nested.
void DocumentEditor::visit(std::uint32_t node) {
  if (place_[node] != kNull) return;
  if (leads_on(nodes_[node])) {
    for (const Field& field : fields_of(node)) {
      if (!holds_nodes(field.spec->type)) continue;
      for (const NodeRef& ref : refs_of(node, field)) {
        if (ref.is_node()) visit(ref.index);
      }
    }
  }
  place_[node] = static_cast<std::uint32_t>(order_.size());
  order_.push_back(node);
}

void DocumentEditor::write(std::uint32_t node) {
  Node& out = result_->nodes.emplace_back(nodes_[node]);
  const std::vector<Field> all = fields_of(node);
  bool as_it_was = all.size() == nodes_[node].given().size();
  std::vector<Field> fields;
  for (const Field& field : all) {
    Field& now = fields.emplace_back(field);
    if (holds_nodes(field.spec->type)) {
      const auto refs = refs_of(node, field);
      const auto placed = result_->arena.allocate<NodeRef>(refs.size());
      std::ranges::transform(refs, placed.begin(), [&](const NodeRef& ref) {
        return NodeRef{ref.is_node() ? place_[ref.index] : kNull, ref.at};
      });
      now.data = placed.data();
      now.count = static_cast<std::uint32_t>(placed.size());
      as_it_was = false;
    } else if (set_.contains({node, field.spec})) {
      now.data = copied_value(result_->arena, field);
      result_->set_values.emplace_back(place_[node], field.spec);
      as_it_was = false;
    }
  }
  if (as_it_was) return;
  out.fields = result_->arena.copy(std::span<const Field>(fields)).data();
  out.field_count = static_cast<std::uint32_t>(fields.size());
}

// Gives each node that something leads to its place in the result.
void DocumentEditor::visit_all() {
  order_.clear();
  place_.assign(nodes_.size(), kNull);
  for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
    if (is_outside_[i]) visit(i);
  }
  for (const NodeRef& ref : top_level_) {
    if (ref.is_node()) visit(ref.index);
  }
}

std::vector<bool> DocumentEditor::reached() {
  visit_all();
  std::vector<bool> reached(nodes_.size());
  for (const std::uint32_t node : order_) reached[node] = true;
  return reached;
}

std::vector<std::uint32_t> DocumentEditor::below(std::uint32_t node) const {
  std::vector<std::uint32_t> open{node};
  std::set<std::uint32_t> found{node};
  while (!open.empty()) {
    const std::uint32_t next = open.back();
    open.pop_back();
    if (!leads_on(nodes_[next])) continue;
    for (const Field& field : fields_of(next)) {
      if (!holds_nodes(field.spec->type)) continue;
      for (const NodeRef& ref : refs_of(next, field)) {
        if (ref.is_node() && found.insert(ref.index).second) open.push_back(ref.index);
      }
    }
  }
  return {found.begin(), found.end()};
}

DocumentEditor::Result DocumentEditor::finish() {
  result_ = std::make_shared<Document>();
  visit_all();
  result_->nodes.reserve(order_.size());
  std::vector<NodeId> ids;
  ids.reserve(order_.size());
  for (const std::uint32_t node : order_) {
    write(node);
    ids.push_back(ids_[node]);
  }
  result_->ids = LastingIds<NodeId>(std::move(ids));
  std::ranges::sort(result_->set_values);

  std::vector<std::uint32_t> source_place(sources_.size(), kNull);
  for (Node& node : result_->nodes) {
    std::uint32_t& place = source_place[node.source];
    if (place == kNull) {
      place = static_cast<std::uint32_t>(result_->sources.size());
      result_->sources.push_back(sources_[node.source]);
    }
    node.source = place;
  }
  for (const NodeRef& ref : top_level_) {
    if (ref.is_node()) result_->top_level.push_back({place_[ref.index], ref.at});
  }
  for (Route route : routes_) {
    route.from_node = place_[route.from_node];
    route.to_node = place_[route.to_node];
    if (route.from_node != kNull && route.to_node != kNull) result_->routes.push_back(route);
  }
  for (InnerName inner : inner_names_) {
    inner.node = place_[inner.node];
    if (inner.node != kNull) result_->inner_names.push_back(inner);
  }
  return {std::move(result_), std::move(place_)};
}

void set_strings(Document& document, std::uint32_t node, std::string_view field, std::span<const std::string> values) {
  const FieldSpec* const spec = find_field(*document.nodes[node].type, field);
  assert(spec != nullptr && (spec->type == FieldType::kSFString || spec->type == FieldType::kMFString));
  const std::vector<std::string_view> views(values.begin(), values.end());
  set_field(
      document, node,
      {spec, copied_strings(document.arena, views), static_cast<std::uint32_t>(views.size()), document.nodes[node].at});
  const std::pair key(node, spec);
  const auto at = std::ranges::lower_bound(document.set_values, key);
  if (at == document.set_values.end() || *at != key) document.set_values.insert(at, key);
}

}  // namespace peerd::vrml
