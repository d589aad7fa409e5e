#pragma once
#include "core/scene/reader.hpp"

namespace peerd {

// Adds a warning for each part of a good world that the file asks something of, and with which no peer ever does it:
// fields, ROUTEs, and ends of interests that have nothing to collide. What depends on who owns a node is not among
// them. Parts of one kind share a warning, which counts them and has the place of the first; a ROUTE from notColliding
// has its own. `maps_hierarchies`: the reader is no peer, and uses hierarchyFiles. Linear in the world, but for a
// logarithm.
void warn_of_inert_parts(ReadResult& result, bool maps_hierarchies = false);

}  // namespace peerd
