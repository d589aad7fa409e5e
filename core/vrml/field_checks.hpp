#pragma once
#include <vector>

#include "core/vrml/document.hpp"

namespace peerd::vrml {

// Whether `field` may hold those values and nodes of `nodes`; reports what it may not.
bool check_nodes(const FieldSpec& spec, const Field& value, const std::vector<Node>& nodes, Problems& problems);
bool check_range(const FieldSpec& spec, const Field& value, Problems& problems);

}  // namespace peerd::vrml
