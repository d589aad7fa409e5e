#include "peerd/input/printable.hpp"

#include "peerd/input/path_text.hpp"

namespace peerd {

std::string printable(std::string_view text, std::size_t most) {
  if (text.size() > most) {
    const auto continues = [&](std::size_t at) { return (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80; };
    while (most > 0 && continues(most)) --most;
    text = text.substr(0, most);
  }
  std::string shown;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto next = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1]) : 0;
    const bool is_c1 = byte == 0xc2 && next >= 0x80 && next < 0xa0;
    shown += byte < 0x20 || byte == 0x7f || is_c1 ? '?' : text[i];
    if (is_c1) ++i;
  }
  return shown;
}

bool is_printable(std::string_view text) { return is_utf8(text) && printable(text, text.size()) == text; }

std::string counted(std::size_t count, const std::string& what, const std::string& plural) {
  return std::to_string(count) + ' ' + (count == 1 ? what : plural.empty() ? what + "s" : plural);
}

}  // namespace peerd
