#pragma once
#include <vector>

#include "core/vrml/document.hpp"

namespace peerd::vrml {

// Both return whether the field may hold the value, whose nodes are among `nodes`, and report why it may not.
bool check_nodes(const FieldSpec& spec, const Field& value, const std::vector<Node>& nodes, Problems& problems);
bool check_range(const FieldSpec& spec, const Field& value, Problems& problems);

}  // namespace peerd::vrml
