#include "core/parser/prototype_parser.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "core/vrml/field_checks.hpp"

namespace peerd::vrml {

using enum TokenKind;

void PrototypeParser::check_name(const Token& name) {
  const bool own = std::ranges::find(kExtensionNodes, name.text) != std::end(kExtensionNodes);
  if (find_node_type(name.text) != nullptr && !own) {
    text_.tokens.fault(text_.tokens.position_of(name),
                       quoted(name.text) + " is a node of the standard: no PROTO can take its name",
                       "the PROTO counts from here on");
  } else if (text_.scope->declarations.contains(name.text)) {
    text_.tokens.warning(text_.tokens.position_of(name),
                         "a PROTO " + quoted(name.text) + " is there already; this one counts from here on");
  }
}

// Passes over a declaration without a name, which it reports.
void PrototypeParser::skip_declaration(const std::string& keyword) {
  text_.tokens.fault(text_.tokens.position(),
                     "expected a name after " + keyword + ", found " + described(text_.tokens.peek()));
  if (text_.tokens.at(kWord)) text_.tokens.take();
  if (text_.tokens.at(kOpenBracket)) text_.skip_balanced();
  if (text_.tokens.at(kOpenBracket) || text_.tokens.at(kOpenBrace)) return text_.skip_balanced();
  if (text_.tokens.at(kString)) text_.tokens.take();
}

void PrototypeParser::parse_proto() {
  const Token keyword = text_.tokens.take();
  if (!text_.tokens.at(kWord) || is_keyword(text_.tokens.peek().text)) return skip_declaration("PROTO");
  const Token name = text_.tokens.take();
  check_name(name);
  Prototype& prototype = text_.context.prototypes.emplace_back();
  prototype.type = {text_.arena.copy(name.text), kAnyClass, NodeRole::kPart, {}};
  if (text_.nesting >= kMaxNesting) {
    text_.tokens.error(text_.tokens.position_of(keyword),
                       "PROTOs and nodes are nested more than " + std::to_string(kMaxNesting) + " deep");
    if (text_.tokens.at(kOpenBracket)) text_.skip_balanced();
    if (text_.tokens.at(kOpenBrace)) text_.skip_balanced();
    return;
  }
  ++text_.nesting;
  OpenNode* const outer_open = std::exchange(open_nodes_.innermost, nullptr);
  interfaces_.parse(name.text, true, prototype);
  parse_body_of(prototype, name.text);
  open_nodes_.innermost = outer_open;
  --text_.nesting;
  Declaration declaration{
      .prototype = &prototype, .interface = prototype.type.fields, .at = text_.tokens.position_of(name)};
  types_.add_native(declaration, name.text);
  text_.scope->declarations[prototype.type.name] = declaration;
}

void PrototypeParser::parse_body_of(Prototype& prototype, std::string_view name) {
  if (!text_.tokens.at(kOpenBrace)) {
    return text_.tokens.fault(text_.tokens.position(), "expected '{' and the body of " + quoted(name) + ", found " +
                                                           described(text_.tokens.peek()));
  }
  const Token brace = text_.tokens.take();
  Scope scope{.outer = text_.scope, .body = &prototype.body, .prototype = &prototype};
  text_.scope = &scope;
  Body& body = prototype.body;
  while (!text_.tokens.at(kCloseBrace)) {
    if (text_.tokens.at(kEnd)) {
      text_.tokens.report_unclosed(text_.tokens.position_of(brace), "PROTO", '}');
      break;
    }
    if (text_.tokens.at(kWord)) {
      if (!grammar_.parse_statement()) body.roots.push_back(grammar_.parse_node());
      continue;
    }
    text_.tokens.fault(text_.tokens.position(),
                       "expected a node or the '}' of " + quoted(name) + ", found " + described(text_.tokens.peek()));
    if (text_.tokens.at(kOpenBrace) || text_.tokens.at(kOpenBracket)) {
      text_.skip_balanced();
    } else {
      text_.tokens.take();
    }
  }
  text_.tokens.accept(kCloseBrace);
  routes_.close(scope);
  text_.scope = scope.outer;
  if (body.roots.empty()) {
    text_.tokens.warning(
        text_.tokens.position_of(brace),
        "the body of " + quoted(name) + " has no node, so its instances are none either; the standard wants one");
  } else if (body.roots.front().is_node()) {
    const NodeType& first = *body.nodes[body.roots.front().index].type;
    prototype.type.classes = first.classes;
  }
  for (const IsLink& link : prototype.links) {
    if (!has_value(link.outer->access) || !has_value(link.inner->access)) continue;
    auto& value = prototype.defaults[static_cast<std::size_t>(link.outer - prototype.type.fields.data())];
    if (!value) continue;  // the default could not be read
    const bool good =
        check_nodes(*link.inner, *value, body.nodes, text_.problems) & check_range(*link.inner, *value, text_.problems);
    if (!good) value.reset();
  }
  sort_links(prototype);
}

void PrototypeParser::parse_externproto() {
  text_.tokens.take();
  if (!text_.tokens.at(kWord) || is_keyword(text_.tokens.peek().text)) return skip_declaration("EXTERNPROTO");
  const Token name = text_.tokens.take();
  check_name(name);
  Prototype interface;
  interfaces_.parse(name.text, false, interface);
  constexpr FieldSpec kUrl{"the URL of an EXTERNPROTO", FieldType::kMFString, Access::kField, {}};
  const std::optional<Field> urls = text_.values.read(kUrl);
  Declaration declaration{.external = true,
                          .interface = interface.type.fields,
                          .urls = urls ? urls->as<std::string_view>() : std::span<const std::string_view>{},
                          .at = text_.tokens.position_of(name)};
  types_.add_native(declaration, name.text);
  text_.scope->declarations[text_.arena.copy(name.text)] = declaration;
}

}  // namespace peerd::vrml
