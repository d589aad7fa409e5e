#pragma once
#include <cstdint>
#include <expected>
#include <limits>
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
  std::uint32_t offset = 0;  // offset of its first byte (the quote of a string) in the text
  std::string_view text;     // into the text that is read
};

// A text that this program has made of another one may write any name at all between two of these bytes, which no world
// may contain: XML allows names that VRML97 does not.
inline constexpr char kNameMark = '\x01';

// A Lexer cuts VRML97 text into tokens (ISO/IEC 14772-1, 4.3 and annex A). Comments and commas are white space. It
// holds no memory of its own: a copy is a bookmark.
class Lexer {
 public:
  // With `marked_names`, a name may stand between two kNameMarks.
  explicit Lexer(std::string_view text, std::size_t begin = 0, bool marked_names = false)
      : text_(text), at_(begin), marked_names_(marked_names) {}
  [[nodiscard]] Token next();
  // Works like next(), but takes nothing of a number and gives no text: for callers of take_numbers() and then next().
  [[nodiscard]] Token next_begin();
  void stop() { at_ = text_.size(); }
  void go_to(std::size_t offset) { at_ = offset; }
  [[nodiscard]] std::size_t offset() const { return at_; }

  // Takes numbers of the plain kind straight from the text up to the first token that is none, and leaves that to
  // next(). Lists of numbers are most of the bytes of a world. Both ways give the same bits for the same text.
  template <class T, class Add>  // float or std::int32_t; Add is told each one, `most` at the most
  void take_numbers(Add add, std::size_t most = std::numeric_limits<std::size_t>::max());
  // Returns how many numbers may stand between here and the next ']': never too few where the list is right, unless a
  // comment holds a ']'.
  struct Count {
    std::size_t numbers = 0;
    std::size_t end = 0;  // the offset of that ']', or of the text's end
  };
  [[nodiscard]] Count count_numbers() const;

 private:
  template <bool kWholeNumbers>
  [[gnu::always_inline]] inline Token cut();
  void skip_white_space();
  Token token(TokenKind kind, std::size_t size);
  Token string();
  Token marked_name();

  std::string_view text_;
  std::size_t at_;
  bool marked_names_;
};

// The languages of worlds. Those of X3D (ISO/IEC 19775, 19776) say the same in two ways.
enum class Dialect : std::uint8_t { kVrml97, kX3dClassic, kX3dXml };

// Checks the first line, "#VRML V2.0 utf8" or "#X3D V3.0 utf8", and gives the offset behind it; or says what the text
// is instead. A text whose first token is a '<' is taken for X3D in XML, which has no such line.
struct Header {
  std::size_t end = 0;
  std::string_view remark;  // harmless deviations from the standard; may be empty
  Dialect dialect = Dialect::kVrml97;
};
struct HeaderError {
  std::string why;
  std::size_t begin = 0;  // where the nodes begin, for a lenient reader
  bool is_fault = false;  // the line is missing or misspelt, and what stands here begins as a world does
};
[[nodiscard]] std::expected<Header, HeaderError> read_header(std::string_view text);

enum class NumberError : std::uint8_t { kSyntax, kNotFinite, kOverflow };

// Returns the binary32 nearest to the text of a number. Underflow gives zero, which is the nearest.
[[nodiscard]] std::expected<float, NumberError> read_float(std::string_view text);
[[nodiscard]] std::expected<double, NumberError> read_double(std::string_view text);
// Returns an integer, decimal or 0x hexadecimal.
[[nodiscard]] std::expected<std::int32_t, NumberError> read_int32(std::string_view text);

// Returns the value of a kString token: \" and \\ are the only escapes.
[[nodiscard]] std::string unescaped(std::string_view text);

// Returns where a number of the plain kind ends: digits, a period and a small exponent, or a decimal integer, that
// white space or a bracket follows. `value` receives the same bits that read_float() and read_int32() give. Returns
// null where the number is of any other kind, right or wrong.
[[nodiscard]] const char* scan_plain(const char* begin, const char* end, float& value);
[[nodiscard]] const char* scan_plain(const char* begin, const char* end, std::int32_t& value);

// Returns whether a word is reserved and cannot name a node (annex A.3).
[[nodiscard]] bool is_keyword(std::string_view word);

template <class T, class Add>
void Lexer::take_numbers(Add add, std::size_t most) {
  for (; most > 0; --most) {
    skip_white_space();
    T value{};
    const char* const end = scan_plain(text_.data() + at_, text_.data() + text_.size(), value);
    if (end == nullptr) return;
    at_ = static_cast<std::size_t>(end - text_.data());
    add(value);
  }
}

}  // namespace peerd::vrml
