#pragma once
#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>

namespace peerd {

// The numbers from `min` to `max`, both included. NaN and the infinities are in no range.
struct NumberRange {
  double min, max;
};

// Coordinates, directions, velocities and times in lists. Larger ones are mistakes, and their squares overflow soon.
inline constexpr NumberRange kCoordinates{-1e9, 1e9};
// The least length of a direction: a much shorter one has 0 as its square, so that it can't be normalised.
inline constexpr double kDirectionMin = 1e-9;

// The reason why a number is refused: "7 is out of range: 0 to 5". Empty where the number is in the range.
[[nodiscard]] std::optional<std::string> why_refused(double number, NumberRange range);

// Reads the number that the whole text is, in decimal digits. The error says what is wrong with it: "nan is no finite
// number".
[[nodiscard]] std::expected<double, std::string> parse_number(std::string_view text, NumberRange range);

// Reads a whole number in the same way, in decimal digits or, after 0x, in hexadecimal ones.
[[nodiscard]] std::expected<std::int64_t, std::string> parse_whole_number(std::string_view text, std::int64_t min,
                                                                          std::int64_t max);

}  // namespace peerd
