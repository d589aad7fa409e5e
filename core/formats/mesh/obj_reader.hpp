#pragma once
#include <string_view>

#include "core/formats/draft/reading.hpp"

namespace peerd::formats {

// Reads a Wavefront OBJ file. Each name that an `o` or a `g` gives becomes a Transform, in the order in which the names
// come first, with a Shape for each material in it. Faces stay polygons; lines (l) and points (p) are Shapes, too.
bool read_obj(std::string_view text, Reading& reading);

}  // namespace peerd::formats
