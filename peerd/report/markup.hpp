#pragma once
#include <string>
#include <string_view>

namespace peerd::report {

// A text as XML and HTML may hold it, between tags or in double quotes: escaped, what is not UTF-8 replaced, control
// characters as spaces.
[[nodiscard]] std::string markup_text(std::string_view text);

}  // namespace peerd::report
