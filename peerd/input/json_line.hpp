#pragma once
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace peerd {

// Prints a value as one line of JSON. Names in old VRML files are Latin-1, and paths are bytes: a byte that is not
// UTF-8 becomes U+FFFD.
[[nodiscard]] std::string json_line(const nlohmann::json& value);

}  // namespace peerd
