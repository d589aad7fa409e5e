#include "core/parser/script_parser.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/vrml/default_values.hpp"

namespace peerd::vrml {

using enum TokenKind;

void ScriptParser::parse_declaration(OpenNode& open) {
  const Token keyword = text_.tokens.take();
  Access access = *text_.access_of(keyword.text);
  const auto type = text_.tokens.at(kWord) ? find_field_type(text_.tokens.peek().text) : std::nullopt;
  if (!type && text_.is_x3d && text_.tokens.at(kWord) && is_x3d_field_type(text_.tokens.peek().text)) {
    const Token other = text_.tokens.take();
    if (!text_.tokens.at(kWord)) return;
    const Token name = text_.tokens.take();
    text_.tokens.warning(text_.tokens.position_of(name), quoted(name.text) + " is left out: its type " +
                                                             std::string(other.text) + ", of X3D, is not kept");
    open.unkept_fields.push_back(text_.arena.copy(name.text));
    if (text_.tokens.at_word("IS")) {
      text_.tokens.take();
      if (text_.tokens.at(kWord)) text_.tokens.take();
    } else if (has_value(access)) {
      open_nodes_.skip_value(text_);
    }
    return;
  }
  if (!type) {
    open.damaged = true;
    text_.tokens.fault(text_.tokens.position(), "expected a field type, found " + described(text_.tokens.peek()));
    if (text_.tokens.at(kWord) && !text_.access_of(text_.tokens.peek().text)) text_.tokens.take();
    if (text_.tokens.at(kWord) && !text_.access_of(text_.tokens.peek().text)) text_.tokens.take();
    return open_nodes_.skip_value(text_);
  }
  text_.tokens.take();
  if (!text_.tokens.at(kWord) || is_keyword(text_.tokens.peek().text)) {
    open.damaged = true;
    text_.tokens.fault(text_.tokens.position(),
                       "expected the name of a field, found " + described(text_.tokens.peek()));
    if (text_.tokens.at(kWord) && !text_.access_of(text_.tokens.peek().text)) text_.tokens.take();
    return has_value(access) ? open_nodes_.skip_value(text_) : void();
  }
  const Token name = text_.tokens.take();
  const bool has_events = text_.is_x3d && access == Access::kExposedField;
  if (access == Access::kExposedField && !has_events) {
    open.damaged = true;
    text_.tokens.fault(text_.tokens.position_of(keyword),
                       "a Script declares fields, eventIns and eventOuts, no exposedFields", "it is read as a field");
    access = Access::kField;
  }
  if (has_events) access = Access::kField;
  if (find_field_of(text_, open, name.text) != nullptr) {
    open.damaged = true;
    text_.tokens.fault(text_.tokens.position_of(name), "this Script has " + quoted(name.text) + " already",
                       "the first one counts");
    if (!has_value(access)) return;
    if (!text_.tokens.at_word("IS")) return open_nodes_.skip_value(text_);
    text_.tokens.take();
    if (text_.tokens.at(kWord)) text_.tokens.take();
    return;
  }
  if (open.own_fields.size() >= kMaxFields) {
    if (!std::exchange(open.damaged, true)) text_.report_too_many_fields(text_.tokens.position_of(name));
    return has_value(access) ? open_nodes_.skip_value(text_) : void();
  }
  const FieldSpec& spec =
      open.own_fields.emplace_back(FieldSpec{text_.arena.copy(name.text), *type, access, {}, Range::kAny, kAnyClass});
  std::array<const FieldSpec*, 2> events{};
  if (has_events) events = add_events(open, spec);
  if (text_.tokens.at_word("IS")) {
    return links_.parse(open, spec, has_events ? Access::kExposedField : access, text_.tokens.position_of(name),
                        events);
  }
  if (!has_value(access)) return;
  // Scripts in the nodes of this field have lists of their own.
  std::vector<Definition*> outer_uses = std::exchange(open_nodes_.script_uses, {});
  if (std::optional<Field> value = text_.values.read(spec)) {
    text_.convert_angles(*open.type, *value);
    open_nodes_.fields.push_back(*value);
    auto around = open_nodes_.script_uses.begin();
    for (const NodeRef& ref : value->as<NodeRef>().first(open_nodes_.script_uses.empty() ? 0 : value->count)) {
      // The arena of the document may be written until it is handed over.
      if (ref.index == kOpenNode) text_.scope->unresolved_refs[*around++].push_back(const_cast<NodeRef*>(&ref));
    }
  } else {
    open.damaged = true;
  }
  open_nodes_.script_uses = std::move(outer_uses);
}

// VRML97 has no exposedFields in Scripts: an inputOutput x of X3D becomes the field x with set_x and x_changed beside
// it.
std::array<const FieldSpec*, 2> ScriptParser::add_events(OpenNode& open, const FieldSpec& field) {
  const auto add = [&](const std::string& name, Access access) -> const FieldSpec* {
    if (const FieldSpec* const declared = find_field_of(text_, open, name)) {
      return declared->access == access && declared->type == field.type ? declared : nullptr;
    }
    return &open.own_fields.emplace_back(
        FieldSpec{text_.arena.copy(std::string_view(name)), field.type, access, {}, Range::kAny, kAnyClass});
  };
  const FieldSpec* const in = add("set_" + std::string(field.name), Access::kEventIn);
  return {in, add(std::string(field.name) + "_changed", Access::kEventOut)};
}

// A field has a value in a document also where the text gave none that could be read, and where its IS brings none.
void ScriptParser::complete_values(OpenNode& open, Position at) {
  std::vector<const FieldSpec*> valued = open.linked;
  for (const Field& field : std::span(open_nodes_.fields).subspan(open.first_field)) valued.push_back(field.spec);
  std::ranges::sort(valued);
  for (const FieldSpec& spec : open.own_fields) {
    if (!has_value(spec.access) || std::ranges::binary_search(valued, &spec)) continue;
    Field value = default_of(spec.type);
    value.spec = &spec;
    value.at = at;
    open_nodes_.fields.push_back(value);
  }
}

void ScriptParser::finish(OpenNode& open, Position at) {
  complete_values(open, at);
  std::vector<FieldSpec> specs(open.type->fields.begin(), open.type->fields.end());
  specs.insert(specs.end(), open.own_fields.begin(), open.own_fields.end());
  NodeType& type = text_.context.document.own_types.emplace_back(*open.type);
  type.fields = text_.arena.copy(std::span<const FieldSpec>(specs));
  for (std::size_t i = open.first_field; i < open_nodes_.fields.size(); ++i)
    open_nodes_.fields[i].spec = find_field(type, open_nodes_.fields[i].spec->name);
  open.type = &type;
  if (open.definition != nullptr) open.definition->type = &type;
  for (const std::string_view name : open.unkept_fields) text_.context.unkept_fields.emplace(&type, name);
}

}  // namespace peerd::vrml
