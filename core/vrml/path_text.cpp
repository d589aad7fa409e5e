#include "core/vrml/path_text.hpp"

#include <algorithm>

namespace peerd {
namespace {

// Returns the place of the first `wanted` outside of quotes, or npos. A quote opens a name only at the beginning of a
// component; elsewhere it is an ordinary byte.
std::size_t find_outside_quotes(std::string_view path, char wanted) {
  bool quoted = false;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (quoted && path[i] == '\\') {
      ++i;
    } else if (path[i] == '"' && (quoted || i == 0 || path[i - 1] == '/')) {
      quoted = !quoted;
    } else if (!quoted && path[i] == wanted) {
      return i;
    }
  }
  return std::string_view::npos;
}

}  // namespace

// A name needs quotes if it is no identifier of VRML97 (annex A.3).
bool needs_quotes(std::string_view name) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) <= 0x20 || c == 0x7f; };
  return name.empty() || (name.front() >= '0' && name.front() <= '9') || name.front() == '+' || name.front() == '-' ||
         std::ranges::any_of(name, is_control) || name.find_first_of("\"#',.[]\\{}") != std::string_view::npos;
}

bool is_index(std::string_view component) {
  return !component.empty() && component.find_first_not_of("0123456789") == std::string_view::npos;
}

std::string in_path(std::string_view name) {
  if (!needs_quotes(name)) return std::string(name);
  std::string out = "\"";
  for (const char c : name) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

std::optional<std::string> unquoted(std::string_view component) {
  if (component.size() < 2 || component.front() != '"' || component.back() != '"') return std::nullopt;
  std::string name;
  for (std::size_t i = 1; i + 1 < component.size(); ++i) {
    if (component[i] == '"') return std::nullopt;
    if (component[i] == '\\' && ++i + 1 >= component.size()) return std::nullopt;
    name += component[i];
  }
  return name;
}

std::size_t component_end(std::string_view path) { return std::min(find_outside_quotes(path, '/'), path.size()); }

std::string_view last_component(std::string_view path) {
  while (true) {
    const std::size_t end = component_end(path);
    if (end == path.size()) return path;
    path.remove_prefix(end + 1);
  }
}

std::size_t list_entry_end(std::string_view paths) { return std::min(find_outside_quotes(paths, ','), paths.size()); }

std::size_t find_star(std::string_view path) { return find_outside_quotes(path, '*'); }

}  // namespace peerd
