#pragma once
#include "core/vrml/arena.hpp"
#include "core/vrml/document.hpp"

namespace peerd::vrml {

// Gives a node the lengths that it has by default, where it does not give them itself, in a unit of so many metres. The
// defaults of the standard are metres whatever the unit of a file is (ISO/IEC 19775-1, 4.3.6).
void give_default_lengths(Node& node, Arena& arena, double metres_per_unit);

}  // namespace peerd::vrml
