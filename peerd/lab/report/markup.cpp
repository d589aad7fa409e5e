#include "peerd/lab/report/markup.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

namespace peerd::report {

std::string markup_text(std::string_view text) {
  std::string clean(text);
  if (std::ranges::any_of(clean, [](char c) { return (c & 0x80) != 0; })) {
    using Json = nlohmann::json;  // its writer replaces bytes that are not UTF-8
    clean = Json::parse(Json(clean).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
  }
  std::string out;
  for (const char c : clean) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
  return out;
}

}  // namespace peerd::report
