#pragma once
#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include "core/formats/draft/reading.hpp"
#include "core/formats/draft/shape_draft.hpp"

namespace peerd::formats {

using Materials = std::map<std::string, MaterialDraft, std::less<>>;

// An OBJ or MTL file may have many keywords that are not read. So many have a warning each, and one more stands for all
// others.
inline constexpr std::size_t kMostNamed = 20;

// Reads a list of materials (MTL) into `materials`. Each statement that has no place in a Material is named once, at
// `offset` of the file that names the list `url`.
bool read_mtl(std::string_view text, std::string_view url, std::size_t offset, Reading& reading, Materials& materials);

}  // namespace peerd::formats
