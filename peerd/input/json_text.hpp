#pragma once
#include <concepts>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace peerd {

// JSON to and from text. The library's parser and serializer are templates that cost seconds in each file that calls
// them; these functions are compiled once.
//
// Names in old VRML files are Latin-1, and paths are bytes: in the written text, a byte that is not UTF-8 becomes
// U+FFFD. The overloads for ordered values are templates, because a string converts to both kinds of value.
template <class T>
concept OrderedJson = std::same_as<T, nlohmann::ordered_json>;

// The value on one line.
[[nodiscard]] std::string json_line(const nlohmann::json& value);
template <OrderedJson Json>
[[nodiscard]] std::string json_line(const Json& value);

// One member or item on each line, indented by `indent` spaces for each level.
[[nodiscard]] std::string json_text(const nlohmann::json& value, int indent = 2);
template <OrderedJson Json>
[[nodiscard]] std::string json_text(const Json& value, int indent = 2);

// Throws nlohmann::json::parse_error.
[[nodiscard]] nlohmann::json parse_json(std::string_view text);
[[nodiscard]] nlohmann::ordered_json parse_ordered_json(std::string_view text);
// The same, but a text that is not JSON gives a value that is_discarded().
[[nodiscard]] nlohmann::json json_if_valid(std::string_view text);

}  // namespace peerd
