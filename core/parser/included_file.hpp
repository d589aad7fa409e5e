#pragma once
#include <string>
#include <string_view>

#include "core/parser/text_state.hpp"

namespace peerd::vrml {

// Opens the file behind a URL for an Inline or an EXTERNPROTO whose value stands at `at`: loads it, unpacks it and adds
// it to ParseContext::open_files, from where the caller removes it. Returns null, and the reason in `why`, where that
// fails; a file that contains itself, or is nested deeper than kMaxOpenFiles, is also reported as an error.
[[nodiscard]] ParseContext::File* open_file(TextState& text, std::string_view url, Position at, std::string& why);

}  // namespace peerd::vrml
