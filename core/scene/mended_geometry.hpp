#pragma once
#include <cstdint>

#include "core/vrml/diagnostics.hpp"
#include "core/vrml/document.hpp"

namespace peerd::vrml {

// No more heights than these are made up for an ElevationGrid: a short text must not ask for billions of them.
inline constexpr std::int64_t kMendedHeightsMax = std::int64_t{1} << 20;

// Gives the geometry nodes of a lenient reading the values that they are understood to have, each with a warning:
// - An index that names no point becomes the corner before it in its polygon, or else the one behind it. Polygons keep
//   their numbers and their corners' places, by which colours and normals count.
// - Heights that an ElevationGrid lacks are 0.
// - The last scale or orientation of an Extrusion serves all spine points that have none.
// Damaged nodes are good from here on, with what was read of them. Written as VRML97, the document reads strictly.
void mend_geometry(Document& document, Problems& problems);

}  // namespace peerd::vrml
