#pragma once
#include "core/vrml/document.hpp"
#include "core/vrml/parse_options.hpp"

namespace peerd::vrml {

// Makes the nodes that only X3D has into nodes of VRML97: TriangleSet, QuadSet, the sets of fans and strips and those
// with an index become IndexedFaceSets of the same polygons, and ColorRGBA becomes Color. What is lost of them is a
// warning. The document is complete, its PROTOs are expanded.
void keep_polygon_sets(Document& document, Problems& problems, const ReadLimits& limits);

}  // namespace peerd::vrml
