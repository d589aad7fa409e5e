#include "core/writer/write_plan.hpp"

#include <algorithm>
#include <cassert>
#include <ranges>

#include "core/vrml/lexer.hpp"
#include "core/vrml/path_text.hpp"

namespace peerd::vrml {
namespace {

constexpr std::uint32_t kNever = ~0u;

bool is_external(const Node& node) {
  return node.type->role == NodeRole::kPart && find_node_type(node.type->name) != node.type;
}

// Returns whether a node may stand at the top level without being seen, heard or sensed there.
bool is_plain(const Node& node) {
  const NodeRole role = node.type->role;
  if (role == NodeRole::kScript || role == NodeRole::kCollisionInterest || role == NodeRole::kKeySensor) return true;
  return role == NodeRole::kPart && !is_external(node) &&
         (node.type->name.ends_with("Interpolator") || node.type->name == "TimeSensor");
}

// The URL of an Inline is lost with it where a Group takes its place.
bool is_written(const Document& document, const Route& route, bool keep_inlines) {
  const auto lost = [&](std::uint32_t node, const FieldSpec* field) {
    return is_filled_inline(document.nodes[node]) && !keep_inlines && field->name == "url";
  };
  return !lost(route.from_node, route.from) && !lost(route.to_node, route.to);
}

// Marks all nodes that the marked ones refer to. Nodes stand behind those that they refer to, but for the nodes around
// a Script that its fields name.
void mark_below(const Document& document, bool content_too, std::vector<bool>& marked) {
  for (std::size_t i = document.nodes.size(); i-- > 0;) {
    if (!marked[i]) continue;
    for (const Field& field : document.nodes[i].given()) {
      if (!holds_nodes(field.spec->type) || (field.spec->access == Access::kContent && !content_too)) continue;
      for (const NodeRef& ref : field.as<NodeRef>()) {
        if (ref.is_node() && ref.index < i) marked[ref.index] = true;
      }
    }
  }
}

std::vector<bool> marked_top_level(const Document& document) {
  std::vector<bool> marked(document.nodes.size(), false);
  for (const NodeRef& ref : document.top_level) {
    if (ref.is_node()) marked[ref.index] = true;
  }
  return marked;
}

// Returns a position behind all PROTOs of the own text of the world that are used, and before all other texts: the last
// reference from a node that stands in that text as it is.
Position last_own_reference(const Document& document) {
  Position last = 0;
  std::vector<bool> own(document.nodes.size(), false);
  const auto refer = [&](const NodeRef& ref) {
    last = std::max(last, ref.at);
    // The copy of the body of a PROTO is where the body is, and not where it is used.
    if (ref.is_node() && document.nodes[ref.index].at == ref.at) own[ref.index] = true;
  };
  for (const NodeRef& ref : document.top_level) refer(ref);
  for (std::size_t i = document.nodes.size(); i-- > 0;) {
    if (!own[i]) continue;
    for (const Field& field : document.nodes[i].given()) {
      if (!holds_nodes(field.spec->type) || field.spec->access == Access::kContent) continue;
      for (const NodeRef& ref : field.as<NodeRef>()) {
        if (ref.index < i) refer(ref);
      }
    }
  }
  return last;
}

}  // namespace

bool is_filled_inline(const Node& node) {
  return node.type->role == NodeRole::kInline && std::ranges::any_of(node.given(), [](const Field& f) {
           return f.spec->access == Access::kContent && f.count > 0;
         });
}

OutsideNodes outside_nodes(const Document& document, const PathRewriter& paths) {
  const std::size_t count = document.nodes.size();
  std::vector<bool> in_scene = marked_top_level(document), in_files = in_scene;
  mark_below(document, false, in_scene);
  mark_below(document, true, in_files);
  std::vector<bool> wanted(count, false);
  for (const Route& route : document.routes) wanted[route.from_node] = wanted[route.to_node] = true;
  std::vector<bool> content(count, false);
  for (const Node& node : document.nodes) {
    if (!is_filled_inline(node)) continue;
    for (const NodeRef& ref : node.find(inline_content().name)->as<NodeRef>()) {
      if (ref.is_node()) content[ref.index] = true;
    }
  }
  mark_below(document, true, content);
  // The nodes that no other node holds belong to PROTOs of the world itself or to an Inline. Those of the world are
  // told by their place in the text, the others by their neighbours: a copy of the body of a PROTO lies together, and
  // the content of an Inline lies before it.
  const Position last_own = last_own_reference(document);
  std::vector<bool> of_inline(count, false);
  bool inside = false;
  for (std::size_t i = 0; i < count; ++i) {
    const Node& node = document.nodes[i];
    const bool filled = is_filled_inline(node);
    if (in_scene[i] || content[i] || (filled && node.at <= last_own)) inside = content[i] && !in_scene[i];
    of_inline[i] = inside && node.scope != 0 && node.at > last_own;
    const NodeRole role = node.type->role;
    const bool acts =
        filled || role == NodeRole::kScript || role == NodeRole::kKeySensor || role == NodeRole::kCollisionInterest;
    wanted[i] = (wanted[i] || acts || !node.def.empty()) && !paths.has_no_target(node);
  }
  OutsideNodes out;
  std::vector<std::uint32_t> roots;
  std::vector<bool>& held = in_files;
  for (std::size_t i = count; i-- > 0;) {
    if (!held[i] && !wanted[i]) continue;
    if (!held[i]) roots.push_back(static_cast<std::uint32_t>(i));
    held[i] = true;
    for (const Field& field : document.nodes[i].given()) {
      if (!holds_nodes(field.spec->type)) continue;
      for (const NodeRef& ref : field.as<NodeRef>()) {
        if (ref.is_node() && ref.index < i) held[ref.index] = true;
      }
    }
  }
  for (const bool inlined : {false, true}) {
    for (const std::uint32_t root : std::views::reverse(roots)) {
      if (of_inline[root] == inlined) (is_plain(document.nodes[root]) ? out.plain : out.held).push_back(root);
    }
    if (!inlined) out.plain_own = out.plain.size();
    if (!inlined) out.held_own = out.held.size();
  }
  return out;
}

WritePlan::WritePlan(const Scene& scene, const WriteOptions& options)
    : scene_(scene),
      document_(*scene.document),
      options_(options),
      paths_(scene),
      outside_(outside_nodes(document_, paths_)) {
  if (options.keep_inlines) {
    outside_.plain.resize(outside_.plain_own);
    outside_.held.resize(outside_.held_own);
  }
  const std::size_t count = document_.nodes.size();
  visited_.assign(count, false);
  defined_.assign(count, 0);
  needed_.assign(count, 0);
  names_.assign(count, {});
  visit_top_level();
  if (too_deep_) return;
  plan_routes();
  choose_names();
  paths_.rename(names_, visited_);
  name_external_types();
}

std::string_view WritePlan::type_name_of(const Node& node) const {
  if (is_filled_inline(node) && !options_.keep_inlines) return "Group";
  const auto it = external_names_.find(node.type);
  return it == external_names_.end() ? node.type->name : it->second;
}

std::vector<WrittenField> WritePlan::fields_of(const Node& node) const {
  std::vector<WrittenField> fields;
  const bool as_group = is_filled_inline(node) && !options_.keep_inlines;
  if (node.type->role != NodeRole::kScript) {
    for (const Field& field : node.given()) {
      const bool content = field.spec->access == Access::kContent;
      if (as_group ? field.spec->name == "url" : content) continue;
      fields.push_back({field.spec, &field, content ? "children" : field.spec->name});
    }
    return fields;
  }
  // The fields of every Script come first, then those that it declares, in that order.
  const std::size_t common = find_node_type("Script")->fields.size();
  const auto place = [&](const FieldSpec* spec) { return static_cast<std::size_t>(spec - node.type->fields.data()); };
  std::vector<const Field*> values(node.type->fields.size(), nullptr);
  for (const Field& field : node.given()) {
    if (place(field.spec) < common) {
      fields.push_back({field.spec, &field, field.spec->name});
    } else {
      values[place(field.spec)] = &field;
    }
  }
  for (std::size_t i = common; i < values.size(); ++i) {
    const FieldSpec& spec = node.type->fields[i];
    fields.push_back({&spec, values[i], spec.name, true});
  }
  return fields;
}

// The walk

WritePlan::RefAction WritePlan::action_at(const NodeRef& ref, std::uint32_t holder, std::vector<bool>& visited) const {
  if (!ref.is_node()) return RefAction::kNull;
  if (visited[ref.index]) return RefAction::kUse;
  if (ref.index >= holder) return RefAction::kLater;
  if (paths_.has_no_target(document_.nodes[ref.index])) return RefAction::kPlaceholder;
  visited[ref.index] = true;
  return RefAction::kDefine;
}

void WritePlan::visit_top_level() {
  for (const NodeRef& ref : document_.top_level) {
    visit_item(ref, NodeRef::kNull, 0);
    end_place();
  }
  for (const std::uint32_t node : outside_.plain) {
    visit_item({node}, NodeRef::kNull, 0);
    end_place();
  }
  for (const std::uint32_t node : outside_.held) visit_item({node}, NodeRef::kNull, 1);
  if (!outside_.held.empty()) end_place();
}

void WritePlan::visit_item(const NodeRef& ref, std::uint32_t holder, std::uint32_t depth) {
  switch (action_at(ref, holder, visited_)) {
    case RefAction::kDefine:
      defined_[ref.index] = ++time_;
      order_.push_back(ref.index);
      visit(ref.index, depth);
      break;
    case RefAction::kUse:
      needed_[ref.index] = ++time_;
      break;
    case RefAction::kPlaceholder:
      notes_.push_back("a CollisionInterest whose object is not part of the scene is left out");
      break;
    case RefAction::kLater:
      notes_.push_back("a Script's field refers to a node that is written behind it: it is written as NULL");
      break;
    case RefAction::kNull:
      break;
  }
}

void WritePlan::visit(std::uint32_t index, std::uint32_t depth) {
  if (depth >= kMaxNesting) {
    too_deep_ = true;
    return;
  }
  bool place = false;
  for (const WrittenField& field : fields_of(document_.nodes[index])) {
    if (!holds_nodes(field.spec->type) || field.value == nullptr) continue;
    place = true;
    for (const NodeRef& ref : field.value->as<NodeRef>()) visit_item(ref, index, depth + 1);
  }
  if (place) end_place();
}

// ROUTEs and names

void WritePlan::plan_routes() {
  std::size_t lost = 0;
  for (std::uint32_t i = 0; i < document_.routes.size(); ++i) {
    const Route& route = document_.routes[i];
    if (!visited_[route.from_node] || !visited_[route.to_node]) continue;  // the ROUTE is in an Inline that stays one
    if (!is_written(document_, route, options_.keep_inlines)) {
      ++lost;
      continue;
    }
    const std::uint32_t both = std::max(defined_[route.from_node], defined_[route.to_node]);
    const auto place = std::ranges::upper_bound(places_, both);
    assert(place != places_.end() && "a place for ROUTEs follows each node at the top level");
    for (const std::uint32_t node : {route.from_node, route.to_node}) needed_[node] = std::max(needed_[node], *place);
    routes_.push_back({i, static_cast<std::uint32_t>(place - places_.begin())});
  }
  if (lost > 0) {
    notes_.push_back(std::to_string(lost) + (lost == 1 ? " ROUTE" : " ROUTEs") +
                     " of the url of an Inline can't be written: a Group takes its place");
  }
}

std::string_view WritePlan::unused_name(std::string_view base, std::uint32_t first) {
  std::uint32_t& number = counters_.try_emplace(base, first).first->second;
  while (true) {
    std::string name = std::string(base) + '_' + std::to_string(number++);
    if (used_names_.contains(name)) continue;
    made_names_.push_back(std::move(name));
    used_names_.insert(made_names_.back());
    return made_names_.back();
  }
}

// Returns an unused name as like to that of a file of another format as VRML97 allows.
std::string_view WritePlan::lawful_name(std::string_view name) {
  std::string lawful(name);
  std::ranges::replace_if(
      lawful,
      [](char c) {
        return needs_quotes(std::string{'_', c});
      },
      '_');
  if (needs_quotes(lawful) || is_keyword(lawful)) lawful.insert(lawful.begin(), '_');
  made_names_.push_back(std::move(lawful));
  const std::string_view made = made_names_.back();
  return used_names_.insert(made).second ? made : unused_name(made, 2);
}

void WritePlan::rename(std::uint32_t node, const std::string& why) {
  const std::string_view old = document_.nodes[node].def;
  names_[node] = unused_name(old, 2);
  notes_.push_back("a node " + std::string(old) + " is written as " + std::string(names_[node]) + ": " + why);
}

// A name means the last node before that has it (4.4.3). So a node keeps its name where no other takes it before it is
// named for the last time.
void WritePlan::choose_names() {
  for (const Node& node : document_.nodes) {
    if (!node.def.empty()) used_names_.insert(node.def);
  }
  std::vector<std::uint32_t> first_instance(document_.nodes.size(), kNever);
  for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
    std::uint32_t& first = first_instance[scene_.instances[i].node];
    first = std::min(first, i);
  }
  // Returns whether a lone name finds the node, and so must go on finding it.
  const auto found_first = [&](std::uint32_t index) {
    const auto first = paths_.first_in_world_scope(document_.nodes[index].def);
    return first && *first == first_instance[index];
  };
  std::unordered_map<std::string_view, std::uint32_t> in_force;  // the node that has the name
  std::vector<bool> shadowed(document_.nodes.size(), false);
  for (const std::uint32_t index : order_) {
    const Node& node = document_.nodes[index];
    if (node.def.empty()) {
      if (needed_[index] > 0) names_[index] = unused_name(type_name_of(node), 1);
      continue;
    }
    if (needs_quotes(node.def) || is_keyword(node.def)) {
      names_[index] = lawful_name(node.def);
      notes_.push_back("a node " + quoted(node.def) + " is written as " + std::string(names_[index]) +
                       ": VRML97 has no such name");
      continue;
    }
    if (node.scope != 0) {
      const auto of_world = paths_.first_in_world_scope(node.def);
      if (of_world && first_instance[index] < *of_world) {
        rename(index, "a node of the world has that name, and paths would find this one first");
        continue;
      }
    }
    names_[index] = node.def;
    const auto [it, is_new] = in_force.try_emplace(node.def, index);
    if (is_new) continue;
    const std::uint32_t before = it->second;
    // Two copies of the ROUTEs of a PROTO are clearer with two names; but the name of an instance is part of paths.
    const bool confusing = needed_[before] > 0 && node.scope != 0 && first_instance[index] == kNever;
    if (needed_[before] <= defined_[index] && !confusing) {
      shadowed[before] = true;
      it->second = index;
    } else if (found_first(index) || (!found_first(before) && document_.nodes[before].scope != 0 && node.scope == 0)) {
      rename(before, "another has that name before a USE or a ROUTE of it");
      it->second = index;
    } else {
      rename(index, "another has that name, and a USE or a ROUTE follows");
    }
  }
  std::ranges::stable_sort(routes_, {}, &PlannedRoute::place);
  early_begin_.assign(places_.size() + 1, 0);
  for (const PlannedRoute& planned : routes_) {
    const Route& route = document_.routes[planned.route];
    if (!shadowed[route.from_node] && !shadowed[route.to_node]) {
      last_routes_.push_back(planned.route);
      continue;
    }
    early_routes_.push_back(planned.route);
    ++early_begin_[planned.place + 1];
  }
  for (std::size_t i = 1; i < early_begin_.size(); ++i) early_begin_[i] += early_begin_[i - 1];
  std::ranges::sort(last_routes_);  // in their original order
}

std::span<const std::uint32_t> WritePlan::routes_at(std::uint32_t place) const {
  return std::span(early_routes_).subspan(early_begin_[place], early_begin_[place + 1] - early_begin_[place]);
}

// Two files, or two PROTOs, may declare different EXTERNPROTOs by one name.
void WritePlan::name_external_types() {
  const auto same = [](const NodeType& a, const NodeType& b) {
    return std::ranges::equal(a.fields, b.fields, [](const FieldSpec& x, const FieldSpec& y) {
      return x.name == y.name && x.type == y.type && x.access == y.access;
    });
  };
  std::unordered_set<std::string_view> taken;
  std::unordered_map<std::string_view, std::vector<const NodeType*>> by_name;
  for (const std::uint32_t index : order_) {
    const Node& node = document_.nodes[index];
    if (is_external(node)) taken.insert(node.type->name);
  }
  for (const std::uint32_t index : order_) {
    const NodeType* const type = document_.nodes[index].type;
    if (!is_external(document_.nodes[index]) || external_names_.contains(type)) continue;
    auto& namesakes = by_name[type->name];
    const auto it = std::ranges::find_if(namesakes, [&](const NodeType* other) { return same(*other, *type); });
    if (it != namesakes.end()) {
      external_names_[type] = external_names_[*it];
      continue;
    }
    std::string_view name = type->name;
    for (std::uint32_t number = 2; !namesakes.empty() && (name == type->name || taken.contains(name)); ++number) {
      made_names_.push_back(std::string(type->name) + '_' + std::to_string(number));
      name = made_names_.back();
    }
    if (name != type->name) {
      taken.insert(name);
      notes_.push_back("an EXTERNPROTO " + std::string(type->name) + " is written as " + std::string(name) +
                       ": another of that name has other fields");
    }
    namesakes.push_back(type);
    external_names_[type] = name;
    external_types_.push_back(type);
  }
}

}  // namespace peerd::vrml
