#include "core/parser/open_nodes.hpp"

#include <algorithm>

namespace peerd::vrml {

const FieldSpec* find_field_of(const TextState& text, const OpenNode& open, std::string_view name) {
  const FieldSpec* field = text.field_of(*open.type, name);
  if (field != nullptr) return field->access == Access::kContent ? nullptr : field;
  const auto it = std::ranges::find(open.own_fields, name, &FieldSpec::name);
  return it == open.own_fields.end() ? nullptr : &*it;
}

bool OpenNodes::is_field(const TextState& text, std::string_view word) const {
  if (innermost == nullptr) return text.access_of(word).has_value();  // in an interface
  return find_field_of(text, *innermost, word) != nullptr ||
         (innermost->type->role == NodeRole::kScript && text.access_of(word).has_value());
}

void OpenNodes::skip_value(TextState& text) {
  std::vector<Definition*> outer_uses = std::exchange(script_uses, {});
  text.define_unreadable(text.values.skip());
  script_uses = std::move(outer_uses);
}

}  // namespace peerd::vrml
