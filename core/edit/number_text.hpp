#pragma once
#include <array>
#include <cassert>
#include <charconv>
#include <span>
#include <string>
#include <system_error>

namespace peerd {

// The shortest text that is read as the same numbers, one blank apart.
[[nodiscard]] inline std::string text_of_numbers(std::span<const float> numbers) {
  std::string text;
  for (const float number : numbers) {
    std::array<char, 32> digits{};
    const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), number);
    assert(error == std::errc());
    text.append(text.empty() ? "" : " ").append(digits.data(), end);
  }
  return text;
}

}  // namespace peerd
