#pragma once
#include <string>
#include <string_view>

#include "peerd/input/input_error.hpp"
#include "peerd/input/secret_text.hpp"

namespace peerd {

// Reads one line from a descriptor, without its end, and nothing of what follows it. Where that is a terminal, the
// prompt is printed to standard error, what is typed is not shown, and a signal that ends the process leaves the
// terminal as it was. `what` names the secret in errors. An empty line is one.
[[nodiscard]] Result<SecretText> read_secret_line(int descriptor, std::string_view prompt, const std::string& what);

}  // namespace peerd
