#include "peerd/input/number.hpp"

#include <charconv>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>
#include <system_error>

namespace peerd {
namespace {

std::string shown(double x) {
  std::ostringstream out;
  out << std::setprecision(12) << x;
  return out.str();
}

std::string is_no(std::string_view text, const char* what) {
  return (text.empty() ? "an empty text" : std::string(text)) + " is no " + what;
}

std::string is_out_of_range(std::string_view text, const std::string& min, const std::string& max) {
  return std::string(text) + " is out of range: " + min + " to " + max;
}

}  // namespace

std::optional<std::string> why_refused(double number, NumberRange range) {
  if (number >= range.min && number <= range.max) return std::nullopt;
  return is_out_of_range(shown(number), shown(range.min), shown(range.max));
}

std::expected<double, std::string> parse_number(std::string_view text, NumberRange range) {
  std::string_view digits = text;
  if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
  double number = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const bool whole_text = end == digits.data() + digits.size();
  // Beyond the range of binary64 the value is unspecified; every such number is out of a range or as good as 0.
  if (whole_text && error == std::errc::result_out_of_range) {
    return std::unexpected(is_out_of_range(text, shown(range.min), shown(range.max)));
  }
  if (!whole_text || error != std::errc{} || !std::isfinite(number)) {
    return std::unexpected(is_no(text, "finite number"));
  }
  if (why_refused(number, range)) return std::unexpected(is_out_of_range(text, shown(range.min), shown(range.max)));
  return number;
}

std::expected<std::int64_t, std::string> parse_whole_number(std::string_view text, std::int64_t min, std::int64_t max) {
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  const std::string_view digits = hexadecimal ? text.substr(2) : text;
  std::int64_t number = 0;
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), number, hexadecimal ? 16 : 10);
  const bool whole_text = end == digits.data() + digits.size() && !(hexadecimal && digits.starts_with('-'));
  const bool too_large = whole_text && error == std::errc::result_out_of_range;
  if (!too_large && (!whole_text || error != std::errc{})) return std::unexpected(is_no(text, "whole number"));
  if (too_large || number < min || number > max) {
    return std::unexpected(is_out_of_range(text, std::to_string(min), std::to_string(max)));
  }
  return number;
}

}  // namespace peerd
