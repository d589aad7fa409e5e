#pragma once
#include <string>
#include <string_view>

namespace peerd::report {

// Escapes a text for XML and HTML, between tags or in double quotes. Bytes that are not UTF-8 are replaced, and control
// characters become spaces.
[[nodiscard]] std::string markup_text(std::string_view text);

// The same, with the line feeds kept.
[[nodiscard]] std::string markup_lines(std::string_view text);

}  // namespace peerd::report
