#pragma once
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace peerd::formats {

// Words cuts a text, or a line of one, at its white space.
class Words {
 public:
  explicit Words(std::string_view text, std::size_t begin = 0) : text_(text), next_(begin) {}

  // Returns the next word; empty at the end.
  [[nodiscard]] std::string_view next() {
    while (next_ < text_.size() && is_space(text_[next_])) ++next_;
    begin_ = next_;
    while (next_ < text_.size() && !is_space(text_[next_])) ++next_;
    return text_.substr(begin_, next_ - begin_);
  }
  // Returns what is left of the line, without white space at its ends, and passes over it.
  [[nodiscard]] std::string_view rest_of_line() {
    const std::size_t end = std::min(text_.find_first_of("\r\n", next_), text_.size());
    std::string_view line = text_.substr(next_, end - next_);
    next_ = end;
    while (!line.empty() && is_space(line.front())) line.remove_prefix(1);
    while (!line.empty() && is_space(line.back())) line.remove_suffix(1);
    return line;
  }
  [[nodiscard]] std::size_t begin() const { return begin_; }  // of the word that next() gave last

 private:
  static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

  std::string_view text_;
  std::size_t next_ = 0, begin_ = 0;
};

// Lines cuts a text at LF, CR LF or CR.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {}

  [[nodiscard]] std::optional<std::string_view> next() {
    if (next_ >= text_.size()) return std::nullopt;
    begin_ = next_;
    const std::size_t end = std::min(text_.find_first_of("\r\n", begin_), text_.size());
    next_ = end + (text_.substr(end, 2) == "\r\n" ? 2 : 1);
    return text_.substr(begin_, end - begin_);
  }
  [[nodiscard]] std::size_t begin() const { return begin_; }  // of the line that next() gave last
  [[nodiscard]] std::size_t after() const { return std::min(next_, text_.size()); }
  [[nodiscard]] std::size_t size() const { return text_.size(); }

 private:
  std::string_view text_;
  std::size_t next_ = 0, begin_ = 0;
};

// Returns the sign of the power of ten of a decimal number's first digit that is not 0: 1 for 12.5 and 1e2, -1 for 0.1.
// It is for numbers that are far from 1, whose power is not 0.
[[nodiscard]] inline int sign_of_exponent(std::string_view number) {
  const std::size_t end = std::min(number.find_first_of("eE"), number.size());
  const std::string_view digits = number.substr(0, end);
  const auto point = static_cast<std::int64_t>(std::min(digits.find('.'), digits.size()));
  const auto first = static_cast<std::int64_t>(std::min(digits.find_first_of("123456789"), digits.size()));
  std::string_view written = number.substr(std::min(end + 1, number.size()));
  if (written.starts_with('+')) written.remove_prefix(1);
  std::int64_t exponent = 0;
  const auto error = std::from_chars(written.data(), written.data() + written.size(), exponent).ec;
  if (error == std::errc::result_out_of_range) return written.starts_with('-') ? -1 : 1;
  // A file is not long enough for its digits to matter beside the largest exponents.
  exponent = std::clamp(exponent, std::int64_t{-1} << 60, std::int64_t{1} << 60);
  return exponent + point - first - (first < point ? 1 : 0) < 0 ? -1 : 1;
}

// Returns the finite number that a word is. A number too small for binary64 is 0.
[[nodiscard]] inline std::optional<double> number_of(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || word.empty()) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    // from_chars does not say whether the number is too large or too small; the exponent of its first digit does.
    return sign_of_exponent(word) < 0 ? std::optional(0.0) : std::nullopt;
  }
  if (error != std::errc{} || !std::isfinite(value)) return std::nullopt;
  return value;
}

[[nodiscard]] inline std::optional<std::int64_t> integer_of(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || word.empty()) return std::nullopt;
  return value;
}

}  // namespace peerd::formats
