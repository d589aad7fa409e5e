#pragma once
#include <filesystem>
#include <string>

#include "peerd/input/input_error.hpp"
#include "peerd/input/text_file.hpp"

namespace peerd {

// The whole content of a file. The error says why it cannot be read and what to do.
[[nodiscard]] Result<std::string> read_text_file(const std::filesystem::path& path);

}  // namespace peerd
