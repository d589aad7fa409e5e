#include "core/parser/node_parser.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/x3d/x3d_defaults.hpp"
#include "core/x3d/x3d_words.hpp"

namespace peerd::vrml {

using enum TokenKind;

NodeRef NodeParser::parse_node() {
  if (text_.tokens.at_word("USE")) return parse_use();
  const Position at = text_.tokens.position();
  Token def;
  if (text_.tokens.at_word("DEF")) {
    text_.tokens.take();
    if (text_.at_name()) {
      def = text_.tokens.take();
    } else if (text_.at_unlawful_name()) {
      def = text_.take_unlawful_name("expected a name after DEF");
    } else {
      text_.tokens.fault(text_.tokens.position(), "expected a name after DEF, found " + described(text_.tokens.peek()),
                         "the node is left out");
      return {NodeRef::kNull, at};
    }
  }
  if (!text_.tokens.at(kWord)) {
    text_.tokens.fault(text_.tokens.position(), "expected a node type, found " + described(text_.tokens.peek()));
    text_.define_unreadable(def.text);
    return {NodeRef::kNull, at};
  }
  const Token type_name = text_.tokens.take();
  return parse_node_body(def, type_name, at);
}

NodeRef NodeParser::parse_use() {
  const Token use = text_.tokens.take();
  const NodeRef null{NodeRef::kNull, text_.tokens.position_of(use)};
  if (!text_.at_name() && !text_.at_unlawful_name()) {
    text_.tokens.fault(text_.tokens.position(),
                       "expected a DEF name after USE, found " + described(text_.tokens.peek()),
                       "the node is left out");
    return null;
  }
  const Token name = text_.at_name() ? text_.tokens.take() : text_.take_unlawful_name("expected a DEF name after USE");
  Definition* const* const named = text_.scope->names.find(name.text);
  if (named == nullptr && text_.scope->prototype == nullptr && text_.scope->outer != nullptr) {
    // A default value stands outside of its PROTO's body, so it may USE what stands before it; as a copy of its own.
    Definition* const* const around = text_.scope->outer->names.find(name.text);
    if (around != nullptr && !(*around)->open && (*around)->node != NodeRef::kNull) {
      const Body& from = *text_.scope->outer->body;
      const NodeSet reached = reachable_nodes(from, (*around)->node);
      if (!text_.context.room_for(reached.nodes.size(), reached.cost, null.at)) return null;
      return {copy_nodes(from, reached, *text_.scope->body, text_.arena), null.at};
    }
  }
  if (named == nullptr) {
    text_.tokens.fault(
        text_.tokens.position_of(name),
        "USE of " + quoted(name.text) + ", which no DEF before it names" + did_you_mean(text_.names_like(name.text)),
        "the node is left out");
    return null;
  }
  Definition& definition = **named;
  if (definition.open) {
    // A Script may refer to itself and to the nodes that it stands in (4.12): it does not contain the nodes that its
    // fields name.
    if (open_nodes_.innermost != nullptr && open_nodes_.innermost->type->role == NodeRole::kScript) {
      open_nodes_.script_uses.push_back(&definition);
      return {kOpenNode, null.at};
    }
    text_.tokens.fault(text_.tokens.position_of(name),
                       "USE of " + quoted(name.text) + " inside that node itself: a node cannot contain itself",
                       "the node is left out");
    return null;
  }
  if (definition.node == NodeRef::kNull) text_.report_lost(definition, name.text, text_.tokens.position_of(name));
  return {definition.node, null.at};
}

void NodeParser::report_unknown_type(const Token& name) {
  const Position at = text_.tokens.position_of(name);
  if (text_.is_x3d && name.text.starts_with("Metadata") && is_unkept_x3d_node(name.text)) {
    return text_.report_metadata(at);
  }
  if (text_.is_x3d && is_unkept_x3d_node(name.text)) {
    return text_.tokens.warning(at, std::string(name.text) +
                                        " is a node of X3D that is not read; the node is left out, with all " +
                                        "that is in it");
  }
  for (Scope* scope = text_.scope; scope != nullptr; scope = scope->outer) {
    if (scope->prototype != nullptr && scope->prototype->type.name == name.text) {
      return text_.tokens.fault(at, quoted(name.text) + " is used inside its own PROTO: it would contain itself",
                                "the node is left out");
    }
  }
  Suggestion suggestion(name.text);
  for (const NodeType& type : node_types()) suggestion.consider(type.name);
  std::vector<std::string_view> names;
  for (Scope* scope = text_.scope; scope != nullptr; scope = scope->outer) {
    if (scope->declarations.size() > kMaxSuggestionNames) continue;
    for (const auto& [known, declaration] : scope->declarations) names.push_back(known);
  }
  std::ranges::sort(names);
  for (const std::string_view known : names) suggestion.consider(known);
  const bool node = text_.tokens.at(kOpenBrace);
  text_.tokens.fault(
      at, (node ? "unknown node type " : "expected a node, found ") + quoted(name.text) + did_you_mean(suggestion),
      "the node is left out");
}

NodeRef NodeParser::parse_node_body(const Token& def, const Token& type_name, Position at) {
  TypeFinder::Type type = types_.find(type_name);
  if (type.type == nullptr) report_unknown_type(type_name);
  if (type.type != nullptr && !text_.tokens.at(kOpenBrace)) {
    text_.tokens.fault(text_.tokens.position(), "expected '{' after " + std::string(type.type->name) + ", found " +
                                                    described(text_.tokens.peek()));
  } else if (type.type != nullptr && text_.nesting >= kMaxNesting) {
    text_.tokens.error(text_.tokens.position_of(type_name),
                       "nodes are nested more than " + std::to_string(kMaxNesting) + " deep");
    type = {};
  }
  if (type.type == nullptr || !text_.tokens.at(kOpenBrace)) {
    text_.define_unreadable(def.text);
    if (text_.tokens.at(kOpenBrace)) {
      text_.skip_balanced();
    } else if (text_.nesting == 0) {
      while (!text_.tokens.at(kEnd) && !(text_.tokens.at(kWord) && (is_keyword(text_.tokens.peek().text) ||
                                                                    find_node_type(text_.tokens.peek().text)))) {
        text_.tokens.take();
      }
    }
    return {NodeRef::kNull, at};
  }

  OpenNode open{.type = type.type, .outer = open_nodes_.innermost, .first_field = open_nodes_.fields.size()};
  if (!def.text.empty()) {
    open.definition = &text_.define(def.text);
    open.definition->type = type.type;
    open.definition->open = true;
  }
  open_nodes_.innermost = &open;
  ++text_.nesting;
  fields_.parse(open);
  --text_.nesting;
  open_nodes_.innermost = open.outer;
  const bool copied = type.prototype != nullptr && type.prototype->not_found == nullptr;
  const NodeRef ref = copied ? close_instance(open, *type.prototype, def, at) : close_node(open, def, at);
  open_nodes_.fields.resize(open.first_field);
  if (open.definition != nullptr) {
    open.definition->node = ref.index;
    open.definition->open = false;
    const auto waiting = text_.scope->unresolved_refs.find(open.definition);
    if (waiting != text_.scope->unresolved_refs.end()) {
      for (NodeRef* const waiter : waiting->second) waiter->index = ref.index;
      text_.scope->unresolved_refs.erase(waiting);
    }
  }
  return ref;
}

void NodeParser::give_x3d_defaults(const OpenNode& open, Position at) {
  for (Field value : x3d_defaults_of(*open.type)) {
    const auto own = std::span<const Field>(open_nodes_.fields).subspan(open.first_field);
    const bool given = std::ranges::find(own, value.spec, &Field::spec) != own.end();
    if (given || std::ranges::find(open.linked, value.spec) != open.linked.end()) continue;
    value.at = at;
    open_nodes_.fields.push_back(value);
  }
}

NodeRef NodeParser::close_node(OpenNode& open, const Token& def, Position at) {
  if (!text_.context.room_for(1, 0, at)) return {NodeRef::kNull, at};
  if (!open.own_fields.empty() || !open.unkept_fields.empty()) scripts_.finish(open, at);
  if (text_.is_x3d) give_x3d_defaults(open, at);
  Body& body = *text_.scope->body;
  const auto fields = text_.arena.copy(std::span<const Field>(open_nodes_.fields).subspan(open.first_field));
  Node node{.type = open.type,
            .fields = fields.data(),
            .def = def.text.empty() ? std::string_view{} : text_.arena.copy(def.text),
            .at = at,
            .scope = text_.scope->id,
            .field_count = static_cast<std::uint32_t>(fields.size()),
            .damaged = open.damaged};
  const ParseContext::File* file = nullptr;
  if (node.type->role == NodeRole::kInline && text_.in_world_body()) file = inlines_.fill(node);
  const auto index = static_cast<std::uint32_t>(body.nodes.size());
  if (file != nullptr && text_.is_x3d) text_.context.inlined.emplace(index, file);
  for (const PendingLink& link : open.links) {
    const FieldSpec* inner = find_field(*open.type, link.inner->name);
    text_.scope->prototype->links.push_back({link.outer, index, inner, link.at});
  }
  for (const Field& field : node.given()) {
    if (field.spec->type == FieldType::kSFNode || field.spec->type == FieldType::kMFNode)
      body.references += field.count;
  }
  body.nodes.push_back(node);
  return {index, at};
}

// An instance stands in the text as a node and in the document as a copy of the prototype's body.
NodeRef NodeParser::close_instance(OpenNode& open, const Prototype& prototype, const Token& def, Position at) {
  const std::span<const Field> given = std::span<const Field>(open_nodes_.fields).subspan(open.first_field);
  const Body& copied = prototype.body;
  const std::uint64_t references =
      copied.references + 2 * copied.routes.size() + prototype.copied_references + cost_of_values(prototype, given);
  if (!text_.context.room_for(copied.nodes.size(), references, at)) return {NodeRef::kNull, at};
  if (text_.in_world_body()) inlines_.load_all_of(prototype, given);
  const double unit = std::exchange(text_.units.length, 1.0);  // no node may come between those of the copy
  Body& body = *text_.scope->body;
  const std::size_t first = body.nodes.size();
  const Expansion copy = expand(prototype, given, body, text_.arena, text_.problems);
  if (text_.in_world_body()) {
    for (std::size_t i = first; i < body.nodes.size(); ++i) {
      if (body.nodes[i].type->role != NodeRole::kInline) continue;
      Node node = body.nodes[i];  // a copy, since reading a file may move all nodes
      const bool filled = inlines_.fill(node) != nullptr;
      body.nodes[i] = node;
      if (filled && unit != 1.0) {
        text_.tokens.warning(
            at, "the UNIT of length has no effect on the file of an Inline in a PROTO: it is not converted");
      }
    }
  }
  text_.units.length = unit;
  for (const PendingLink& link : open.links) {
    for (const IsLink& inner : links_of(prototype.links, *link.inner)) {
      if (!text_.context.room_for(0, 4, at)) break;  // sort_links() keeps it twice
      text_.scope->prototype->links.push_back({link.outer, copy.base + inner.node, inner.inner, link.at});
    }
  }
  if (open.definition != nullptr) {
    open.definition->prototype = &prototype;
    open.definition->base = copy.base;
  }
  if (copy.root != NodeRef::kNull) {
    Node& root = body.nodes[copy.root];
    root.damaged |= open.damaged;
    if (!def.text.empty()) {
      // The DEF name that the PROTO gives its first node is known inside of it only.
      if (!root.def.empty()) body.inner_names.push_back({root.scope, root.def, copy.root});
      root.def = text_.arena.copy(def.text);
      root.scope = text_.scope->id;
    }
  }
  return {copy.root, at};
}

}  // namespace peerd::vrml
