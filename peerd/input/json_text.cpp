#include "peerd/input/json_text.hpp"

#include <nlohmann/json.hpp>

namespace peerd {
namespace {

template <class Json>
std::string text_of(const Json& value, int indent) {
  return value.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

using nlohmann::json;
using nlohmann::ordered_json;

std::string json_line(const json& value) { return text_of(value, -1); }
std::string json_text(const json& value, int indent) { return text_of(value, indent); }

template <OrderedJson Json>
std::string json_line(const Json& value) {
  return text_of(value, -1);
}
template std::string json_line(const ordered_json&);

template <OrderedJson Json>
std::string json_text(const Json& value, int indent) {
  return text_of(value, indent);
}
template std::string json_text(const ordered_json&, int);

json parse_json(std::string_view text) { return json::parse(text); }
ordered_json parse_ordered_json(std::string_view text) { return ordered_json::parse(text); }
json json_if_valid(std::string_view text) { return json::parse(text, nullptr, /*allow_exceptions=*/false); }

}  // namespace peerd
