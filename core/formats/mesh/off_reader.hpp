#pragma once
#include <string_view>

#include "core/formats/draft/reading.hpp"

namespace peerd::formats {

// Reads an OFF file of text ([ST][C][N]OFF): one Transform with one Shape, whose polygons are the file's faces. Colours
// of points come with COFF, those of faces stand behind their indices.
bool read_off(std::string_view text, Reading& reading);

}  // namespace peerd::formats
