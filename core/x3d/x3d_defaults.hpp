#pragma once
#include <vector>

#include "core/vrml/document.hpp"

namespace peerd::vrml {

// Returns the fields of a node that have another value in X3D than in VRML97 where a text gives none, with that value.
// Lengths are in metres, angles in radians.
[[nodiscard]] std::vector<Field> x3d_defaults_of(const NodeType& type);

}  // namespace peerd::vrml
