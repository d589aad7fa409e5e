#include "core/parser/text_parser.hpp"

#include <string>
#include <utility>

#include "core/vrml/field_checks.hpp"

namespace peerd::vrml {

using enum TokenKind;

TextParser::TextParser(ParseContext& context, Position text_begin, std::size_t begin, std::uint32_t nesting)
    : text_(context, text_begin, begin, nesting),
      routes_(text_),
      types_(text_),
      prototypes_(text_, open_nodes_, routes_, types_, *this),
      nodes_(text_, open_nodes_, types_, *this) {
  text_.values.set_parser([this](const FieldSpec& spec) { return parse_node_value(spec); },
                          [this](std::string_view word) { return open_nodes_.is_field(word); });
}

Declarations TextParser::parse_text(Body& body) {
  Scope scope{.body = &body};
  if (text_.context.open_files.size() > 1 || &body != &text_.context.world) scope.id = body.scopes++;
  text_.scope = &scope;
  while (!text_.tokens.at(kEnd)) {
    if (text_.tokens.at(kWord)) {
      const Position at = text_.tokens.position();
      if (parse_statement()) continue;
      const NodeRef ref = parse_node();
      if (ref.is_node() && (body.nodes[ref.index].type->classes & kChild) == 0) {
        text_.tokens.warning(
            at, std::string(body.nodes[ref.index].type->name) + " at the top level is not part of the scene by itself");
      }
      body.roots.push_back(ref);
      continue;
    }
    text_.tokens.fault(text_.tokens.position(), "expected a node, found " + described(text_.tokens.peek()));
    while (!text_.tokens.at(kEnd) && !text_.tokens.at(kWord)) text_.tokens.take();
  }
  routes_.close(scope);
  return std::move(scope.declarations);
}

bool TextParser::parse_statement() {
  if (text_.tokens.at_word("PROTO")) return prototypes_.parse_proto(), true;
  if (text_.tokens.at_word("EXTERNPROTO")) return prototypes_.parse_externproto(), true;
  if (text_.tokens.at_word("ROUTE")) return routes_.parse(), true;
  return false;
}

std::optional<NodeRef> TextParser::parse_node_value(const FieldSpec& spec) {
  if (parse_statement()) return std::nullopt;
  std::optional<NodeRef> value(parse_node());
  NodeRef& ref = *value;
  const Field one{&spec, &ref, 1, ref.at};
  if (ref.is_node() && ref.index != kOpenNode && !check_nodes(spec, one, text_.scope->body->nodes, text_.problems))
    ref.index = NodeRef::kNull;
  return value;
}

}  // namespace peerd::vrml
