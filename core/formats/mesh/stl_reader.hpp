#pragma once
#include <string_view>

#include "core/formats/draft/reading.hpp"

namespace peerd::formats {

// Read an STL file: each solid becomes a Transform of its name with one Shape, each facet a polygon of it. Corners at
// one place, bit for bit, are one point. The normals of facets are not read, for the corners say them.
bool read_stl_text(std::string_view text, Reading& reading);
bool read_stl_binary(std::string_view bytes, Reading& reading);

}  // namespace peerd::formats
