#pragma once
#include <string_view>

#include "core/vrml/document.hpp"

namespace peerd::vrml {

// Returns the value that a field has where the text gives none. Events and the fields of prototypes and scripts have no
// such value.
[[nodiscard]] const Field& default_of(const FieldSpec& spec);

// Returns the value that a Script's or a PROTO's field of that type has where its declaration gives none. Its `spec` is
// that of no field.
[[nodiscard]] const Field& default_of(FieldType type);

// Returns the value of `field`, given or default.
[[nodiscard]] const Field& value_of(const Node& node, std::string_view field);

}  // namespace peerd::vrml
