#pragma once
#include <string_view>

#include "core/formats/draft/reading.hpp"

namespace peerd::formats {

// Reads a PLY file, of text or binary in either byte order: one Transform with one Shape. Faces are its polygons, and
// strips of triangles (tristrips) are cut into theirs; a file without either is a cloud of points.
bool read_ply(std::string_view bytes, Reading& reading);

}  // namespace peerd::formats
