#include "core/parser/interface_parser.hpp"

#include <algorithm>
#include <string>
#include <unordered_set>
#include <vector>

namespace peerd::vrml {

using enum TokenKind;

namespace {

// The declarations of an interface that have been read so far.
struct Interface {
  std::vector<FieldSpec> specs{};
  std::vector<std::optional<Field>> defaults{};
  std::unordered_set<std::string_view> names{};

  [[nodiscard]] bool has(std::string_view name) const { return names.contains(name); }
  // An exposedField x is also set_x and x_changed (4.7).
  [[nodiscard]] bool conflicts(std::string_view name, Access access) const {
    if (has(name)) return true;
    if (access == Access::kExposedField) return has("set_" + std::string(name)) || has(std::string(name) + "_changed");
    const auto exposed = [&](std::string_view base) {
      const auto it = std::ranges::find(specs, base, &FieldSpec::name);
      return it != specs.end() && it->access == Access::kExposedField;
    };
    return (name.starts_with("set_") && exposed(name.substr(4))) ||
           (name.ends_with("_changed") && exposed(name.substr(0, name.size() - 8)));
  }
  void add(const FieldSpec& spec, const std::optional<Field>& value) {
    names.insert(spec.name);
    specs.push_back(spec);
    defaults.push_back(value);
  }
};

void keep(Interface& interface, Prototype& prototype, Arena& arena) {
  const auto kept = arena.copy(std::span<const FieldSpec>(interface.specs));
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (interface.defaults[i]) interface.defaults[i]->spec = &kept[i];
  }
  prototype.type.fields = kept;
  prototype.defaults = std::move(interface.defaults);
}

}  // namespace

// Passes over tokens to the next declaration of an interface, or to its end.
void InterfaceParser::skip_to_declaration() {
  while (!text_.tokens.at(kEnd) && !text_.tokens.at(kCloseBracket) && !text_.tokens.at(kCloseBrace)) {
    if (text_.tokens.at(kWord) && text_.access_of(text_.tokens.peek().text)) return;
    if (text_.tokens.at(kOpenBracket) || text_.tokens.at(kOpenBrace)) {
      text_.skip_balanced();
    } else {
      text_.tokens.take();
    }
  }
}

// Reads FIELDTYPE NAME, or reports an error.
std::optional<std::pair<FieldType, Token>> InterfaceParser::parse_type_and_name() {
  const auto type = text_.tokens.at(kWord) ? find_field_type(text_.tokens.peek().text) : std::nullopt;
  if (!type) {
    Suggestion suggestion(text_.tokens.peek().text);
    for (int t = 0; t <= static_cast<int>(FieldType::kMFVec3f); ++t)
      suggestion.consider(name_of(static_cast<FieldType>(t)));
    text_.tokens.fault(text_.tokens.position(),
                       "expected a field type, found " + described(text_.tokens.peek()) + did_you_mean(suggestion),
                       "the declaration is left out");
    return std::nullopt;
  }
  text_.tokens.take();
  if (!text_.tokens.at(kWord) || is_keyword(text_.tokens.peek().text)) {
    text_.tokens.fault(text_.tokens.position(), "expected the name of a field, found " + described(text_.tokens.peek()),
                       "the declaration is left out");
    return std::nullopt;
  }
  return std::pair(*type, text_.tokens.take());
}

bool InterfaceParser::skip_unkept(Prototype& prototype, bool has_default) {
  if (!text_.is_x3d || !text_.tokens.at(kWord) || !is_x3d_field_type(text_.tokens.peek().text)) return false;
  const Token type = text_.tokens.take();
  if (!text_.tokens.at(kWord)) return true;
  const Token name = text_.tokens.take();
  text_.tokens.warning(text_.tokens.position_of(name), quoted(name.text) + " is left out: its type " +
                                                           std::string(type.text) + ", of X3D, is not kept");
  text_.context.unkept_fields.emplace(&prototype.type, text_.arena.copy(name.text));
  if (has_default) static_cast<void>(text_.values.skip());
  return true;
}

// The nodes of a default value stand in the body of the prototype, and are in none of its names (4.4.3).
std::optional<Field> InterfaceParser::parse_default(const FieldSpec& spec, Prototype& prototype) {
  Scope scope{.outer = text_.scope, .body = &prototype.body};
  Scope* const outer = std::exchange(text_.scope, &scope);
  std::optional<Field> value = text_.values.read(spec);
  if (value) text_.convert_angles(prototype.type, *value);
  routes_.close(scope);
  text_.scope = outer;
  return value;
}

bool InterfaceParser::parse(std::string_view name, bool with_values, Prototype& prototype) {
  if (!text_.tokens.at(kOpenBracket)) {
    text_.tokens.fault(text_.tokens.position(), "expected '[' and the interface of " + quoted(name) + ", found " +
                                                    described(text_.tokens.peek()));
    return false;
  }
  const Token bracket = text_.tokens.take();
  const std::string accesses =
      text_.is_x3d ? "inputOnly, outputOnly, initializeOnly, inputOutput" : "eventIn, eventOut, field, exposedField";
  Interface interface;
  bool good = true;
  while (!text_.tokens.at(kCloseBracket)) {
    if (text_.tokens.at(kEnd)) {
      good = false;
      text_.tokens.report_unclosed(text_.tokens.position_of(bracket), "interface", ']');
      break;
    }
    const auto access = text_.tokens.at(kWord) ? text_.access_of(text_.tokens.peek().text) : std::nullopt;
    if (!access) {
      good = false;
      text_.tokens.fault(text_.tokens.position(), "expected " + accesses + " or ']' in the interface of " +
                                                      quoted(name) + ", found " + described(text_.tokens.peek()));
      if (text_.tokens.at(kCloseBrace) || text_.tokens.at(kOpenBrace)) break;  // the ']' is missing
      skip_to_declaration();
      continue;
    }
    text_.tokens.take();
    if (skip_unkept(prototype, with_values && has_value(*access))) continue;
    const auto type_and_name = parse_type_and_name();
    if (!type_and_name) {
      good = false;
      skip_to_declaration();
      continue;
    }
    const auto& [type, field] = *type_and_name;
    const bool conflicts = interface.conflicts(field.text, *access);
    if (conflicts) {
      good = false;
      text_.tokens.fault(text_.tokens.position_of(field),
                         quoted(field.text) + " is in the interface of " + quoted(name) + " already",
                         "the first one counts");
    }
    const FieldSpec spec{text_.arena.copy(field.text), type, *access, {}, Range::kAny, kAnyClass};
    std::optional<Field> value;
    if (with_values && has_value(*access)) {
      value = parse_default(spec, prototype);
      good = good && value.has_value();
      if (!value) skip_to_declaration();
    }
    if (conflicts) continue;
    if (interface.specs.size() == kMaxFields) text_.report_too_many_fields(text_.tokens.position_of(field));
    if (interface.specs.size() < kMaxFields) interface.add(spec, value);
  }
  text_.tokens.accept(kCloseBracket);
  keep(interface, prototype, text_.arena);
  return good;
}

}  // namespace peerd::vrml
