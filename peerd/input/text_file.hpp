#pragma once
#include <filesystem>
#include <string>

#include "peerd/input/input_error.hpp"
#include "peerd/input/text_file.hpp"

namespace peerd {

// Reads the whole content of a file. The error says why the file cannot be read and what to do.
[[nodiscard]] Result<std::string> read_text_file(const std::filesystem::path& path);

}  // namespace peerd
