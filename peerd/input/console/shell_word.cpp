#include "peerd/input/console/shell_word.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace peerd {

std::string shell_word(const std::string& word) {
  const auto plain = [](unsigned char c) { return std::isalnum(c) != 0 || std::string_view("/._-=+:,@").contains(c); };
  if (!word.empty() && std::ranges::all_of(word, plain)) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace peerd
