#include "peerd/input/path_text.hpp"

#include <cctype>
#include <charconv>

#include <spdlog/fmt/fmt.h>

namespace peerd {
namespace {

constexpr std::string_view kScheme = "file://";

// The bytes of the character that begins with that one; 0: none does.
std::size_t length_of(unsigned char first) {
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first < 0xE0) return 2;
  if (first >= 0xE0 && first < 0xF0) return 3;
  return first >= 0xF0 && first < 0xF5 ? 4 : 0;
}

}  // namespace

// After RFC 3629: no overlong forms, no surrogates, nothing beyond U+10FFFF.
bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const std::size_t length = length_of(byte(0));
    if (length == 0 || length > text.size()) return false;
    for (std::size_t i = 1; i < length; ++i) {
      if ((byte(i) & 0xC0) != 0x80) return false;
    }
    if (length > 1) {
      const bool is_overlong = (byte(0) == 0xE0 && byte(1) < 0xA0) || (byte(0) == 0xF0 && byte(1) < 0x90);
      const bool is_none = (byte(0) == 0xED && byte(1) >= 0xA0) || (byte(0) == 0xF4 && byte(1) >= 0x90);
      if (is_overlong || is_none) return false;
    }
    text.remove_prefix(length);
  }
  return true;
}

std::string path_text(const std::filesystem::path& path) {
  const std::string& bytes = path.native();
  if (is_utf8(bytes)) return bytes;
  std::string uri(kScheme);
  for (const char c : bytes) {
    const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string_view("/-_.~").contains(c);
    uri += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri;
}

std::filesystem::path path_of_text(const std::string& text) {
  if (!text.starts_with(kScheme)) return text;
  std::string bytes;
  for (std::size_t i = kScheme.size(); i < text.size(); ++i) {
    unsigned byte = 0;
    const char *const begin = text.data() + i + 1, *const end = begin + 2;
    const bool is_escape = text[i] == '%' && i + 2 < text.size() && std::from_chars(begin, end, byte, 16).ptr == end;
    bytes += is_escape ? static_cast<char>(byte) : text[i];
    if (is_escape) i += 2;
  }
  return bytes;
}

}  // namespace peerd
