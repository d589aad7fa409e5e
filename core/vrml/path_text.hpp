#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace peerd {

// A path is names, or child indices, joined by '/'. A name that VRML97 could not have, as the files of other formats
// give them, stands in quotes: "left arm"/"3". In quotes, \" is a quote and \\ a backslash.

// Returns whether a name must be quoted in a path.
[[nodiscard]] bool needs_quotes(std::string_view name);
// Returns whether an unquoted component can only be a child index: names of digits are quoted.
[[nodiscard]] bool is_index(std::string_view component);
// Returns the name as it stands in a path.
[[nodiscard]] std::string in_path(std::string_view name);
// Returns the name that a quoted component of a path is; nothing where it is not quoted.
[[nodiscard]] std::optional<std::string> unquoted(std::string_view component);

// Returns where the first component of a path ends: at its first '/' outside of quotes, or at its end.
[[nodiscard]] std::size_t component_end(std::string_view path);
[[nodiscard]] std::string_view last_component(std::string_view path);
// Returns the place of the first '*' outside of quotes; npos where there is none.
[[nodiscard]] std::size_t find_star(std::string_view path);

// Returns where the first path of a list ends: at its first ',' outside of quotes, or at its end.
[[nodiscard]] std::size_t list_entry_end(std::string_view paths);

}  // namespace peerd
