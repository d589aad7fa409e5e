#pragma once
#include <concepts>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace peerd {

// Prints a value as one line of JSON. Names in old VRML files are Latin-1, and paths are bytes: a byte that is not
// UTF-8 becomes U+FFFD.
[[nodiscard]] std::string json_line(const nlohmann::json& value);
// The same of a value with its members in order. A template, so that a string is not both kinds of value.
template <std::same_as<nlohmann::ordered_json> Json>
[[nodiscard]] std::string json_line(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace peerd
