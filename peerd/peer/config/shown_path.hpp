#pragma once
#include <string>
#include <string_view>

namespace peerd::config {

// Returns a path or a pattern as a message shows it: in quotes, and in single ones where it has quotes itself.
[[nodiscard]] inline std::string shown(std::string_view path) {
  const char quote = path.contains('"') ? '\'' : '"';
  return quote + std::string(path) + quote;
}

}  // namespace peerd::config
