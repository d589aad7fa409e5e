#pragma once
#include <expected>
#include <optional>
#include <string>
#include <string_view>

#include "core/vrml/diagnostics.hpp"

namespace peerd::vrml {

enum class TokenKind : std::uint8_t {
  kEnd,
  kOpenBrace,
  kCloseBrace,
  kOpenBracket,
  kCloseBracket,
  kPeriod,
  kWord,    // a name or keyword
  kNumber,  // begins like a number; read_float() and the like decide whether it is one
  kString,  // `text` without its quotes, escapes still in it
  kUnterminatedString,
  kInvalid,  // bytes that no token may contain
};

struct Token {
  TokenKind kind = TokenKind::kEnd;
  std::string_view text;  // into the text that is read
  Spot spot;
};

// Cuts VRML97 text into tokens (ISO/IEC 14772-1, 4.3 and annex A). Comments and commas are white space. Holds no memory
// of its own: a copy is a bookmark.
class Lexer {
 public:
  explicit Lexer(std::string_view text, Spot begin = {});
  [[nodiscard]] Token next();
  void stop() { at_ = text_.size(); }

 private:
  void skip_white_space();
  void end_line();
  Token token(TokenKind kind, std::size_t size);
  Token string();

  std::string_view text_;
  std::size_t at_;
  std::size_t line_begin_;
  std::uint32_t line_;
};

// Checks the first line, "#VRML V2.0 utf8", and gives the place behind it; or says what the text is instead.
[[nodiscard]] std::expected<Spot, std::string> read_header(std::string_view text);

enum class NumberError : std::uint8_t { kSyntax, kNotFinite, kOverflow };

// The nearest binary32 to a number's text. Underflow gives zero, which is the nearest.
[[nodiscard]] std::expected<float, NumberError> read_float(std::string_view text);
[[nodiscard]] std::expected<double, NumberError> read_double(std::string_view text);
// Decimal or 0x hexadecimal.
[[nodiscard]] std::expected<std::int32_t, NumberError> read_int32(std::string_view text);

// The value of a kString token: \" and \\ are the only escapes.
[[nodiscard]] std::string unescaped(std::string_view text);

// Whether a word is reserved and cannot name a node (annex A.3).
[[nodiscard]] bool is_keyword(std::string_view word);

}  // namespace peerd::vrml
