#pragma once
#include <filesystem>
#include <string_view>

#include "peerd/input/input_error.hpp"

namespace peerd::store {

// Writes a file that is there as a whole, on the disk, or as it was before, whatever happens meanwhile.
[[nodiscard]] Result<void> write_durably(const std::filesystem::path& file, std::string_view bytes);

}  // namespace peerd::store
