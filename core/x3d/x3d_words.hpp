#pragma once
#include <optional>
#include <string_view>

#include "core/vrml/node_types.hpp"

namespace peerd::vrml {

// The words of X3D (ISO/IEC 19775-1), as far as they are others than those of VRML97.

// Returns the type behind a name of X3D: one of VRML97, or one that keep_polygon_sets() makes one of VRML97.
[[nodiscard]] const NodeType* find_x3d_type(std::string_view name);
// Returns whether X3D has a node of that name that no document keeps.
[[nodiscard]] bool is_unkept_x3d_node(std::string_view name);

// Returns the name that a field of a node has in VRML97.
[[nodiscard]] std::string_view vrml_field_name(std::string_view node, std::string_view x3d_name);
// Returns the field of the node around it that a node of that name belongs to, where XML does not say it.
[[nodiscard]] std::string_view container_of(std::string_view name);

// Returns the access that a word of X3D means, or of VRML97, which old files of X3D use.
[[nodiscard]] std::optional<Access> find_x3d_access(std::string_view word);
[[nodiscard]] std::string_view x3d_name_of(Access access);

}  // namespace peerd::vrml
