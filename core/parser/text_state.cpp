#include "core/parser/text_state.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "core/x3d/x3d_words.hpp"

namespace peerd::vrml {

Definition& TextState::define(std::string_view name) {
  scope->definitions.emplace_back();
  scope->names.set(name, &scope->definitions.back());
  return scope->definitions.back();
}

void TextState::define_unreadable(std::string_view name) {
  if (!name.empty()) define(name);
}

void TextState::define_unreadable(const std::vector<std::string_view>& names) {
  for (const std::string_view name : names) define_unreadable(name);
}

bool TextState::at_name() { return tokens.at(TokenKind::kWord) && !is_keyword(tokens.peek().text); }

bool TextState::at_unlawful_name() {
  return tokens.at(TokenKind::kNumber) || (tokens.at(TokenKind::kWord) && is_keyword(tokens.peek().text));
}

Token TextState::take_unlawful_name(const std::string& expected) {
  const Position at = tokens.position();
  Token name = tokens.take();
  std::string read_as = "_" + std::string(name.text);
  std::ranges::replace_if(
      read_as, [](char c) { return c == '.' || c == '#'; }, '_');
  tokens.fault(at, expected + ", found " + described(name), "it is read as " + vrml::quoted(read_as));
  name.text = arena.copy(std::string_view(read_as));
  return name;
}

Suggestion TextState::names_like(std::string_view name) const {
  Suggestion suggestion(name);
  std::vector<std::string_view> names;  // in an order that doesn't depend on where they stand
  if (scope->names.table().size() <= kMaxSuggestionNames) {
    for (const auto& [known, definition] : scope->names.table()) names.push_back(known);
  }
  std::ranges::sort(names);
  for (const std::string_view known : names) suggestion.consider(known);
  return suggestion;
}

std::optional<Access> TextState::access_of(std::string_view word) const {
  return is_x3d ? find_x3d_access(word) : find_access(word);
}

std::string TextState::name_of(Access access) const {
  return std::string(is_x3d ? x3d_name_of(access) : vrml::name_of(access));
}

const FieldSpec* TextState::field_of(const NodeType& type, std::string_view name) const {
  return find_field(type, is_x3d ? vrml_field_name(type.name, name) : name);
}

const ExtraField* TextState::unkept_field_of(const NodeType& type, std::string_view name) const {
  if (!is_x3d) return nullptr;
  if (const ExtraField* const extra = find_extra_field(type.name, name)) return extra;
  if (name.starts_with("set_")) return find_extra_field(type.name, name.substr(4));
  return name.ends_with("_changed") ? find_extra_field(type.name, name.substr(0, name.size() - 8)) : nullptr;
}

void TextState::report_metadata(Position at) {
  if (std::exchange(metadata_reported, true)) return;
  tokens.warning(at, "metadata is not kept, here and in the rest of this file");
}

void TextState::report_lost(Definition& definition, std::string_view name, Position at) {
  if (!is_x3d || std::exchange(definition.loss_reported, true)) return;
  tokens.warning(at, vrml::quoted(name) + " is a node that was left out; a USE of it is empty, a ROUTE is left out");
}

void TextState::convert_angles(const NodeType& type, Field& value) {
  constexpr std::array<std::string_view, 9> kAngles{"creaseAngle", "fieldOfView", "skyAngle",
                                                    "groundAngle", "minAngle",    "maxAngle",
                                                    "diskAngle",   "beamWidth",   "cutOffAngle"};
  const FieldSpec& spec = *value.spec;
  const bool rotation = spec.type == FieldType::kSFRotation || spec.type == FieldType::kMFRotation;
  const bool angle = std::ranges::find(kAngles, spec.name) != kAngles.end() ||
                     (type.name == "CylinderSensor" && spec.name == "offset") ||
                     (type.name == "TextureTransform" && spec.name == "rotation");
  if (units.angle == 1.0 || (!rotation && (!angle || float_count(spec.type) != 1))) return;
  const std::span<float> converted = arena.allocate<float>(value.count);
  for (std::size_t i = 0; i < converted.size(); ++i) {
    const float number = value.as<float>()[i];
    const bool converts = !rotation || i % 4 == 3;
    converted[i] = converts ? static_cast<float>(static_cast<double>(number) * units.angle) : number;
  }
  value.data = converted.data();
}

void TextState::report_too_many_fields(Position at) {
  tokens.error(at,
               "with this field there are more than " + std::to_string(kMaxFields) + ", more than this reader takes");
}

}  // namespace peerd::vrml
