#include "peerd/lab/report/markup.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"

namespace peerd::report {

std::string markup_text(std::string_view text) {
  std::string clean(text);
  if (std::ranges::any_of(clean, [](char c) { return (c & 0x80) != 0; })) {
    // The writer of JSON replaces bytes that are not UTF-8.
    clean = parse_json(json_line(nlohmann::json(clean))).get<std::string>();
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

std::string markup_lines(std::string_view text) {
  std::string out;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    out += markup_text(text.substr(begin, end - begin)) + '\n';
    begin = end + 1;
  }
  return out;
}

}  // namespace peerd::report
