#include "core/parser/text_parser.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <span>
#include <string>
#include <utility>

#include "core/vrml/field_checks.hpp"
#include "core/x3d/default_lengths.hpp"
#include "core/x3d/head_statements.hpp"

namespace peerd::vrml {

using enum TokenKind;

TextParser::TextParser(ParseContext& context, const OpenText& text, std::uint32_t nesting)
    : text_(context, text, nesting),
      routes_(text_),
      types_(text_),
      prototypes_(text_, open_nodes_, routes_, types_, *this),
      nodes_(text_, open_nodes_, types_, *this) {
  text_.values.set_parser([this](const FieldSpec& spec) { return parse_node_value(spec); },
                          [this](std::string_view word) { return open_nodes_.is_field(text_, word); });
}

Declarations TextParser::parse_text(Body& body) {
  Scope scope{.body = &body};
  if (text_.context.open_files.size() > 1 || &body != &text_.context.world) scope.id = body.scopes++;
  text_.scope = &scope;
  const std::size_t first_root = body.roots.size(), first_node = body.nodes.size();
  while (!text_.tokens.at(kEnd)) {
    if (text_.tokens.at(kWord)) {
      const Position at = text_.tokens.position();
      if (text_.is_x3d && read_head_statement(text_.tokens, text_.units)) continue;
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
  close_exports();
  warn_of_shared_imports();
  convert_lengths(body, first_root, first_node);
  return std::move(scope.declarations);
}

bool TextParser::parse_statement() {
  if (text_.is_x3d) {
    const bool node = text_.tokens.at(kWord) && text_.tokens.kind_after() == kOpenBrace;
    if (!node && text_.tokens.at_word("IMPORT")) return parse_import(), true;
    if (!node && text_.tokens.at_word("EXPORT")) return parse_export(), true;
  }
  if (text_.tokens.at_word("PROTO")) return prototypes_.parse_proto(), true;
  if (text_.tokens.at_word("EXTERNPROTO")) return prototypes_.parse_externproto(), true;
  if (text_.tokens.at_word("ROUTE")) return routes_.parse(), true;
  return false;
}

std::optional<Token> TextParser::take_name(std::string_view statement) {
  if (text_.at_name()) return text_.tokens.take();
  text_.tokens.fault(text_.tokens.position(),
                     "expected a name in " + std::string(statement) + ", found " + described(text_.tokens.peek()),
                     "the statement is left out");
  return std::nullopt;
}

void TextParser::parse_import() {
  text_.tokens.take();
  const std::optional<Token> inline_name = take_name("IMPORT");
  if (!inline_name) return;
  if (!text_.tokens.accept(kPeriod)) {
    return text_.tokens.fault(text_.tokens.position(), "expected '.' and the name of a node behind the Inline " +
                                                           quoted(inline_name->text) + " in IMPORT");
  }
  const std::optional<Token> exported = take_name("IMPORT");
  if (!exported) return;
  std::optional<Token> local = exported;
  if (text_.tokens.at_word("AS")) {
    text_.tokens.take();
    local = take_name("IMPORT");
  }
  if (!local) return;
  const auto lost = [&](const Token& where, const std::string& why) {
    text_.tokens.warning(text_.tokens.position_of(where), "this IMPORT is left out: " + why);
    text_.define_unreadable(text_.arena.copy(local->text));
  };
  if (!text_.in_world_body()) return lost(*inline_name, "the nodes of an Inline in a PROTO have no names outside");
  Definition* const* const named = text_.scope->names.find(inline_name->text);
  if (named == nullptr) return lost(*inline_name, "no DEF before it names " + quoted(inline_name->text));
  const auto file = text_.context.inlined.find((*named)->node);
  if (file == text_.context.inlined.end()) {
    return lost(*inline_name, quoted(inline_name->text) + " is no Inline with a file of X3D that has been read");
  }
  const auto found = file->second->exports.find(exported->text);
  if (found == file->second->exports.end()) {
    return lost(*exported, "the file of " + quoted(inline_name->text) + " exports no " + quoted(exported->text));
  }
  text_.define(text_.arena.copy(local->text)) = found->second;
  imports_.emplace_back(text_.tokens.position_of(*inline_name), file->second);
}

void TextParser::parse_export() {
  text_.tokens.take();
  const std::optional<Token> name = take_name("EXPORT");
  if (!name) return;
  std::optional<Token> exported = name;
  if (text_.tokens.at_word("AS")) {
    text_.tokens.take();
    exported = take_name("EXPORT");
  }
  if (exported && text_.in_world_body()) exports_.emplace_back(*name, text_.arena.copy(exported->text));
}

void TextParser::close_exports() {
  for (const auto& [name, exported] : exports_) {
    Definition* const* const named = text_.scope->names.find(name.text);
    if (named == nullptr) {
      text_.tokens.warning(text_.tokens.position_of(name),
                           "EXPORT of " + quoted(name.text) + ", which no DEF names; it is left out");
      continue;
    }
    const auto file = text_.context.files.find(text_.context.open_files.back());
    if (file != text_.context.files.end()) file->second.exports.insert_or_assign(exported, **named);
  }
}

// Inlines of one file show the same nodes here, where X3D has nodes of its own for each.
void TextParser::warn_of_shared_imports() {
  for (const auto& [at, file] : imports_) {
    const auto shows = [&](const auto& inlined) { return inlined.second == file; };
    if (std::ranges::count_if(text_.context.inlined, shows) < 2) continue;
    text_.tokens.warning(at, "what this IMPORT does to the file of an Inline, it does to all Inlines of that file");
  }
}

void TextParser::convert_lengths(Body& body, std::size_t first, std::size_t first_node) {
  if (text_.units.length == 1.0) return;
  if (&body != &text_.context.world) {
    return text_.tokens.warning(text_.begin,
                                "the UNIT of length has no effect on the PROTOs that another file takes from "
                                "here: it reads them in metres");
  }
  for (Node& node : std::span(body.nodes).subspan(first_node)) {
    if (text_.problems.begin_of(node.at) == text_.begin) give_default_lengths(node, text_.arena, text_.units.length);
  }
  const auto begin = body.roots.begin() + static_cast<std::ptrdiff_t>(first);
  const auto converts = [&](const NodeRef& ref) {
    return ref.is_node() && (body.nodes[ref.index].type->classes & kChild) != 0 &&
           body.nodes[ref.index].type->name != "WorldInfo" && body.nodes[ref.index].type->name != "CollisionInterest";
  };
  const auto kept = std::ranges::stable_partition(begin, body.roots.end(), std::not_fn(converts)).begin();
  if (kept == body.roots.end() || !text_.context.room_for(1, body.roots.size(), text_.begin)) return;
  const NodeRef scaled = add_scale(text_, text_.units.length, std::span<const NodeRef>(kept, body.roots.end()));
  body.roots.erase(kept, body.roots.end());
  body.roots.push_back(scaled);
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
