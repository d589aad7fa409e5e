#pragma once
#include <string_view>

namespace peerd::vrml {

// An ExtraField is a field that X3D gives to a node of VRML97, and that no document keeps.
struct ExtraField {
  static constexpr std::string_view kEvent = "\n";  // no value has this text

  std::string_view node, field;
  std::string_view type;           // for people, and by it a value is cut from XML
  std::string_view default_value;  // as VRML text; kEvent where the field has events alone

  [[nodiscard]] bool is_event() const { return default_value == kEvent; }
};

// Returns null where the node has no such field in X3D, or has it in VRML97, too.
[[nodiscard]] const ExtraField* find_extra_field(std::string_view node, std::string_view field);

// Returns whether X3D has a field type of that name that VRML97 does not have.
[[nodiscard]] bool is_x3d_field_type(std::string_view type);

}  // namespace peerd::vrml
