#pragma once
#include <string_view>

#include "core/vrml/document.hpp"

namespace peerd::vrml {

// The value that a field has where the text gives none. Not for events, nor for fields of prototypes and scripts.
[[nodiscard]] const Field& default_of(const FieldSpec& spec);

// The value of `field`, given or default.
[[nodiscard]] const Field& value_of(const Node& node, std::string_view field);

}  // namespace peerd::vrml
