#pragma once
#include "core/vrml/arena.hpp"
#include "core/vrml/document.hpp"

namespace peerd::vrml {

// Writes the default lengths of a node into its fields, in the unit of its file. The standard's defaults are in metres
// whatever that unit is (ISO/IEC 19775-1, 4.3.6), and the whole file is scaled to metres later.
void give_default_lengths(Node& node, Arena& arena, double metres_per_unit);

}  // namespace peerd::vrml
