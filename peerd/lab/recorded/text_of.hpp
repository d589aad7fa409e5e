#pragma once
#include <string>

#include <nlohmann/json.hpp>

namespace peerd::recorded {

// Prints a value as one line of JSON, its keys in their order; a byte that is not UTF-8 becomes U+FFFD.
[[nodiscard]] inline std::string text_of(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace peerd::recorded
