#include "core/vrml/text_parser.hpp"
#include "core/vrml/field_checks.hpp"

#include <algorithm>
#include <utility>

namespace peerd::vrml {

using enum TokenKind;

Definition& TextParser::define(std::string_view name) {
  scope_->definitions.emplace_back();
  scope_->names.set(name, &scope_->definitions.back());
  return scope_->definitions.back();
}

Declarations TextParser::parse_text(Body& body) {
  Scope scope{.body = &body};
  if (context_.open_files.size() > 1 || &body != &context_.world) scope.id = body.scopes++;
  scope_ = &scope;
  while (!tokens_.at(kEnd)) {
    if (tokens_.at(kWord)) {
      const Position at = tokens_.position();
      if (parse_statement()) continue;
      const NodeRef ref = parse_node();
      if (ref.is_node() && (body.nodes[ref.index].type->classes & kChild) == 0) {
        tokens_.warning(
            at, std::string(body.nodes[ref.index].type->name) + " at the top level is not part of the scene by itself");
      }
      body.roots.push_back(ref);
      continue;
    }
    tokens_.error(tokens_.position(), "expected a node, found " + described(tokens_.peek()));
    while (!tokens_.at(kEnd) && !tokens_.at(kWord)) tokens_.take();
  }
  close(scope);
  return std::move(scope.declarations);
}

bool TextParser::parse_statement() {
  if (tokens_.at_word("PROTO")) return parse_proto(), true;
  if (tokens_.at_word("EXTERNPROTO")) return parse_externproto(), true;
  if (tokens_.at_word("ROUTE")) return parse_route(), true;
  return false;
}

std::optional<NodeRef> TextParser::parse_node_value(const FieldSpec& spec) {
  if (parse_statement()) return std::nullopt;
  std::optional<NodeRef> value(parse_node());
  NodeRef& ref = *value;
  const Field one{&spec, &ref, 1, ref.at};
  if (ref.is_node() && ref.index != kOpenNode && !check_nodes(spec, one, scope_->body->nodes, problems_))
    ref.index = NodeRef::kNull;
  return value;
}

NodeRef TextParser::parse_node() {
  if (tokens_.at_word("USE")) return parse_use();
  const Position at = tokens_.position();
  Token def;
  if (tokens_.at_word("DEF")) {
    tokens_.take();
    if (!tokens_.at(kWord) || is_keyword(tokens_.peek().text)) {
      tokens_.error(tokens_.position(), "expected a name after DEF, found " + described(tokens_.peek()));
      if (!tokens_.at(kWord) && !tokens_.at(kNumber)) return {NodeRef::kNull, at};
      tokens_.take();
    } else {
      def = tokens_.take();
    }
  }
  if (!tokens_.at(kWord)) {
    tokens_.error(tokens_.position(), "expected a node type, found " + described(tokens_.peek()));
    define_unreadable(def.text);
    return {NodeRef::kNull, at};
  }
  const Token type_name = tokens_.take();
  return parse_node_body(def, type_name, at);
}

NodeRef TextParser::parse_use() {
  const Token use = tokens_.take();
  const NodeRef null{NodeRef::kNull, tokens_.position_of(use)};
  if (!tokens_.at(kWord) || is_keyword(tokens_.peek().text)) {
    tokens_.error(tokens_.position(), "expected a DEF name after USE, found " + described(tokens_.peek()));
    return null;
  }
  const Token name = tokens_.take();
  Definition* const* const named = scope_->names.find(name.text);
  if (named == nullptr && scope_->prototype == nullptr && scope_->outer != nullptr) {
    // A default value stands outside of its PROTO's body, so it may USE what stands before it; as a copy of its own.
    Definition* const* const around = scope_->outer->names.find(name.text);
    if (around != nullptr && !(*around)->open && (*around)->node != NodeRef::kNull) {
      const Body& from = *scope_->outer->body;
      const NodeSet reached = reachable_nodes(from, (*around)->node);
      if (!context_.room_for(reached.nodes.size(), reached.cost, null.at)) return null;
      return {copy_nodes(from, reached, *scope_->body, arena_), null.at};
    }
  }
  if (named == nullptr) {
    tokens_.error(tokens_.position_of(name), "USE of " + quoted(name.text) + ", which no DEF before it names" +
                                                 did_you_mean(names_like(name.text)));
    return null;
  }
  Definition& definition = **named;
  if (definition.open) {
    // A Script may be told of itself and of what it stands in (4.12): it doesn't contain what its fields name.
    if (open_ != nullptr && open_->type->role == NodeRole::kScript) {
      script_uses_.push_back(&definition);
      return {kOpenNode, null.at};
    }
    tokens_.error(tokens_.position_of(name),
                  "USE of " + quoted(name.text) + " inside that node itself: a node cannot contain itself");
    return null;
  }
  return {definition.node, null.at};
}

void TextParser::report_unknown_type(const Token& name) {
  const Position at = tokens_.position_of(name);
  for (Scope* scope = scope_; scope != nullptr; scope = scope->outer) {
    if (scope->prototype != nullptr && scope->prototype->type.name == name.text) {
      return tokens_.error(at, quoted(name.text) + " is used inside its own PROTO: it would contain itself");
    }
  }
  Suggestion suggestion(name.text);
  for (const NodeType& type : node_types()) suggestion.consider(type.name);
  std::vector<std::string_view> names;
  for (Scope* scope = scope_; scope != nullptr; scope = scope->outer) {
    if (scope->declarations.size() > kMaxSuggestionNames) continue;
    for (const auto& [known, declaration] : scope->declarations) names.push_back(known);
  }
  std::ranges::sort(names);
  for (const std::string_view known : names) suggestion.consider(known);
  const bool node = tokens_.at(kOpenBrace);
  tokens_.error(
      at, (node ? "unknown node type " : "expected a node, found ") + quoted(name.text) + did_you_mean(suggestion));
}

NodeRef TextParser::parse_node_body(const Token& def, const Token& type_name, Position at) {
  Type type = find_type(type_name);
  if (type.type == nullptr) report_unknown_type(type_name);
  if (type.type != nullptr && !tokens_.at(kOpenBrace)) {
    tokens_.error(tokens_.position(),
                  "expected '{' after " + std::string(type.type->name) + ", found " + described(tokens_.peek()));
  } else if (type.type != nullptr && nesting_ >= kMaxNesting) {
    tokens_.error(tokens_.position_of(type_name),
                  "nodes are nested more than " + std::to_string(kMaxNesting) + " deep");
    type = {};
  }
  if (type.type == nullptr || !tokens_.at(kOpenBrace)) {
    define_unreadable(def.text);
    if (tokens_.at(kOpenBrace)) {
      skip_balanced();
    } else if (nesting_ == 0) {
      while (!tokens_.at(kEnd) &&
             !(tokens_.at(kWord) && (is_keyword(tokens_.peek().text) || find_node_type(tokens_.peek().text)))) {
        tokens_.take();
      }
    }
    return {NodeRef::kNull, at};
  }

  OpenNode open{.type = type.type, .outer = open_, .first_field = fields_.size()};
  if (!def.text.empty()) {
    open.definition = &define(def.text);
    open.definition->type = type.type;
    open.definition->open = true;
  }
  open_ = &open;
  ++nesting_;
  parse_fields(open);
  --nesting_;
  open_ = open.outer;
  const bool copied = type.prototype != nullptr && type.prototype->not_found == nullptr;
  const NodeRef ref = copied ? close_instance(open, *type.prototype, def, at) : close_node(open, def, at);
  fields_.resize(open.first_field);
  if (open.definition != nullptr) {
    open.definition->node = ref.index;
    open.definition->open = false;
    const auto waiting = scope_->unresolved_refs.find(open.definition);
    if (waiting != scope_->unresolved_refs.end()) {
      for (NodeRef* const waiter : waiting->second) waiter->index = ref.index;
      scope_->unresolved_refs.erase(waiting);
    }
  }
  return ref;
}

NodeRef TextParser::close_node(OpenNode& open, const Token& def, Position at) {
  if (!context_.room_for(1, 0, at)) return {NodeRef::kNull, at};
  if (!open.own_fields.empty()) finish_script(open);
  Body& body = *scope_->body;
  const auto fields = arena_.copy(std::span<const Field>(fields_).subspan(open.first_field));
  Node node{.type = open.type,
            .fields = fields.data(),
            .def = def.text.empty() ? std::string_view{} : arena_.copy(def.text),
            .at = at,
            .scope = scope_->id,
            .field_count = static_cast<std::uint32_t>(fields.size()),
            .damaged = open.damaged};
  if (node.type->role == NodeRole::kInline && in_world_body()) fill_inline(node);
  const auto index = static_cast<std::uint32_t>(body.nodes.size());
  for (const PendingLink& link : open.links) {
    const FieldSpec* inner = find_field(*open.type, link.inner->name);
    scope_->prototype->links.push_back({link.outer, index, inner, link.at});
  }
  for (const Field& field : node.given()) {
    if (field.spec->type == FieldType::kSFNode || field.spec->type == FieldType::kMFNode)
      body.references += field.count;
  }
  body.nodes.push_back(node);
  return {index, at};
}

// An instance stands in the text as a node and in the document as a copy of the prototype's body.
NodeRef TextParser::close_instance(OpenNode& open, const Prototype& prototype, const Token& def, Position at) {
  const std::span<const Field> given = std::span<const Field>(fields_).subspan(open.first_field);
  const Body& copied = prototype.body;
  const std::uint64_t references =
      copied.references + 2 * copied.routes.size() + prototype.copied_references + cost_of_values(prototype, given);
  if (!context_.room_for(copied.nodes.size(), references, at)) return {NodeRef::kNull, at};
  if (in_world_body()) load_inlines_of(prototype, given);
  Body& body = *scope_->body;
  const std::size_t first = body.nodes.size();
  const Expansion copy = expand(prototype, given, body, arena_, problems_);
  if (in_world_body()) {
    for (std::size_t i = first; i < body.nodes.size(); ++i) {
      if (body.nodes[i].type->role != NodeRole::kInline) continue;
      Node node = body.nodes[i];  // not in place: reading a file may move all nodes
      fill_inline(node);
      body.nodes[i] = node;
    }
  }
  for (const PendingLink& link : open.links) {
    for (const IsLink& inner : links_of(prototype.links, *link.inner)) {
      if (!context_.room_for(0, 4, at)) break;  // sort_links() keeps it twice
      scope_->prototype->links.push_back({link.outer, copy.base + inner.node, inner.inner, link.at});
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
      // What the PROTO calls its first node is known inside of it only.
      if (!root.def.empty()) body.inner_names.push_back({root.scope, root.def, copy.root});
      root.def = arena_.copy(def.text);
      root.scope = scope_->id;
    }
  }
  return {copy.root, at};
}

// A Script's type is its own: the fields of every Script and those that it declares.
void TextParser::finish_script(OpenNode& open) {
  std::vector<FieldSpec> specs(open.type->fields.begin(), open.type->fields.end());
  specs.insert(specs.end(), open.own_fields.begin(), open.own_fields.end());
  NodeType& type = context_.document.own_types.emplace_back(*open.type);
  type.fields = arena_.copy(std::span<const FieldSpec>(specs));
  for (std::size_t i = open.first_field; i < fields_.size(); ++i)
    fields_[i].spec = find_field(type, fields_[i].spec->name);
  open.type = &type;
  if (open.definition != nullptr) open.definition->type = &type;
}

}  // namespace peerd::vrml
