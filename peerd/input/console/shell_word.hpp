#pragma once
#include <string>

namespace peerd {

// The word as a POSIX shell takes it for one, quoted where need be.
[[nodiscard]] std::string shell_word(const std::string& word);

}  // namespace peerd
