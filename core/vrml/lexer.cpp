#include "core/vrml/lexer.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

namespace peerd::vrml {
namespace {

enum CharClass : std::uint8_t {
  kIdFirst = 1,  // may begin a name
  kIdRest = 2,   // may continue one
  kNumeric = 4,  // may continue a number, right or wrong: 12abc is one bad number, not a number and a name
  kSpace = 8,    // comma included
};

constexpr std::array<std::uint8_t, 256> kCharClasses = [] {
  std::array<std::uint8_t, 256> classes{};
  constexpr std::string_view kNeverInId = "\"#',.[\\]{}\x7f";
  for (int c = 0x21; c < 256; ++c) {
    const bool rest = kNeverInId.find(static_cast<char>(c)) == std::string_view::npos;
    const bool digit = c >= '0' && c <= '9';
    const bool sign = c == '+' || c == '-';
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    classes[c] = static_cast<std::uint8_t>((rest && !digit && !sign ? kIdFirst : 0) | (rest ? kIdRest : 0) |
                                           (digit || sign || letter || c == '.' ? kNumeric : 0));
  }
  for (const char c : {' ', '\t', '\n', '\r', ','}) classes[static_cast<unsigned char>(c)] = kSpace;
  return classes;
}();

bool is(char c, CharClass kind) { return (kCharClasses[static_cast<unsigned char>(c)] & kind) != 0; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::size_t run(std::string_view text, std::size_t at, CharClass kind) {
  const char* const begin = text.data() + at;
  const char* const end = text.data() + text.size();
  const char* to = begin;
  while (to != end && is(*to, kind)) ++to;
  return static_cast<std::size_t>(to - begin);
}

std::string_view without_plus(std::string_view text) {
  const bool plus = text.size() > 1 && text[0] == '+' && (is_digit(text[1]) || text[1] == '.');
  return plus ? text.substr(1) : text;
}

// Returns whether a well-formed number that no binary64 can hold is too small rather than too large: by the decimal
// exponent of its first digit that is not 0.
bool is_tiny(std::string_view number) {
  const std::size_t mark = std::min(number.find_first_of("eE"), number.size());
  const std::string_view digits = number.substr(0, mark);
  const std::size_t first = digits.find_first_of("123456789");
  if (first == std::string_view::npos) return true;
  const auto period = static_cast<std::int64_t>(std::min(digits.find('.'), digits.size()));
  std::int64_t exponent = 0;
  if (mark < number.size()) {
    const std::string_view written = without_plus(number.substr(mark + 1));
    if (std::from_chars(written.data(), written.data() + written.size(), exponent).ec != std::errc{}) {
      return written.starts_with('-');
    }
  }
  return exponent < static_cast<std::int64_t>(first) - period;
}

template <class Real>
std::expected<Real, NumberError> read_real(std::string_view text) {
  const std::string_view number = without_plus(text);
  Real value{};
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (error == std::errc::invalid_argument || end != number.data() + number.size()) {
    return std::unexpected(NumberError::kSyntax);
  }
  if (error == std::errc::result_out_of_range) {
    if (is_tiny(number)) return number.starts_with('-') ? -Real{0} : Real{0};
    return std::unexpected(NumberError::kOverflow);
  }
  if (!std::isfinite(value)) {
    const bool written_so = number.find_first_of("0123456789") == std::string_view::npos;
    return std::unexpected(written_so ? NumberError::kNotFinite : NumberError::kOverflow);
  }
  return value;
}

}  // namespace

void Lexer::skip_white_space() {
  const char* const end = text_.data() + text_.size();
  const char* at = text_.data() + at_;
  while (true) {
    while (at != end && is(*at, kSpace)) ++at;
    if (at == end || *at != '#') break;
    while (at != end && *at != '\n' && *at != '\r') ++at;
  }
  at_ = static_cast<std::size_t>(at - text_.data());
}

// The loop takes eight bytes at a time. All bytes up to the blank are taken for white space: the control bytes among
// them that are none stand in no right list.
Lexer::Count Lexer::count_numbers() const {
  const char* const begin = text_.data() + at_;
  const void* const bracket = std::memchr(begin, ']', text_.size() - at_);
  const char* const end = bracket == nullptr ? text_.data() + text_.size() : static_cast<const char*>(bracket);
  constexpr std::uint64_t kEach = 0x0101010101010101u, kHigh = 0x80 * kEach, kLow = 0x7f * kEach;
  std::size_t count = 0;
  std::uint64_t before = 0;  // 0x80: the last byte was no white space
  const char* at = begin;
  for (; end - at >= 8; at += 8) {
    std::uint64_t bytes = 0;
    std::memcpy(&bytes, at, sizeof bytes);
    if constexpr (std::endian::native == std::endian::big) bytes = std::byteswap(bytes);
    const std::uint64_t above_blank = ((bytes & kLow) + (0x7f - ' ') * kEach) | bytes;
    const std::uint64_t from_comma = bytes ^ ',' * kEach;
    const std::uint64_t no_comma = ((from_comma & kLow) + kLow) | from_comma;
    const std::uint64_t solid = above_blank & no_comma & kHigh;
    const std::uint64_t begins = solid & ~(solid << 8 | before);
    count += (begins >> 7) * kEach >> 56;
    before = solid >> 56;
  }
  bool in_space = before == 0;
  for (; at != end; ++at) {
    const bool space = is(*at, kSpace);
    count += static_cast<std::size_t>(in_space && !space);
    in_space = space;
  }
  return {count, static_cast<std::size_t>(end - text_.data())};
}

Token Lexer::token(TokenKind kind, std::size_t size) {
  const Token t{kind, static_cast<std::uint32_t>(at_), {text_.data() + at_, size}};
  at_ += size;
  return t;
}

Token Lexer::string() {
  Token t = token(TokenKind::kUnterminatedString, 1);
  const std::size_t begin = at_;
  while (at_ < text_.size()) {
    const char c = text_[at_];
    if (c == '"') {
      t.kind = TokenKind::kString;
      t.text = text_.substr(begin, at_++ - begin);
      return t;
    }
    at_ += c == '\\' && at_ + 1 < text_.size() && (text_[at_ + 1] == '"' || text_[at_ + 1] == '\\') ? 2 : 1;
  }
  t.text = text_.substr(begin);
  return t;
}

Token Lexer::marked_name() {
  const std::size_t end = std::min(text_.find(kNameMark, at_ + 1), text_.size());
  Token name{TokenKind::kWord, static_cast<std::uint32_t>(at_), text_.substr(at_ + 1, end - at_ - 1)};
  at_ = std::min(end + 1, text_.size());
  return name;
}

template <bool kWholeNumbers>
Token Lexer::cut() {
  skip_white_space();
  if (at_ >= text_.size()) return token(TokenKind::kEnd, 0);
  const char c = text_[at_];
  if (is(c, kIdFirst)) return token(TokenKind::kWord, run(text_, at_, kIdRest));
  const bool number =
      is_digit(c) || c == '+' || c == '-' || (c == '.' && at_ + 1 < text_.size() && is_digit(text_[at_ + 1]));
  if (number) {
    if (!kWholeNumbers) return token(TokenKind::kNumber, 0);
    std::size_t size = run(text_, at_, kNumeric);
    // Some exporters write NaN and infinity as "1.#QNAN", "-1.#IND", "1.#INF". These are not a number and a comment.
    if (at_ + size < text_.size() && text_[at_ + size] == '#') {
      const std::string_view rest = text_.substr(at_ + size);
      for (const std::string_view mark : {"#IND", "#QNAN", "#SNAN", "#INF"}) {
        if (rest.starts_with(mark)) size += mark.size();
      }
    }
    return token(TokenKind::kNumber, size);
  }
  switch (c) {
    case '{':
      return token(TokenKind::kOpenBrace, 1);
    case '}':
      return token(TokenKind::kCloseBrace, 1);
    case '[':
      return token(TokenKind::kOpenBracket, 1);
    case ']':
      return token(TokenKind::kCloseBracket, 1);
    case '.':
      return token(TokenKind::kPeriod, 1);
    case '"':
      return string();
    case kNameMark:
      if (marked_names_) return marked_name();
      break;
    default:
      break;
  }
  std::size_t size = 1;
  const auto no_token = [](char b) { return kCharClasses[static_cast<unsigned char>(b)] == 0; };
  while (at_ + size < text_.size() && no_token(text_[at_ + size]) &&
         std::string_view("\"#.[]{}").find(text_[at_ + size]) == std::string_view::npos) {
    ++size;
  }
  return token(TokenKind::kInvalid, size);
}

Token Lexer::next() { return cut<true>(); }
Token Lexer::next_begin() { return cut<false>(); }

namespace {

// Returns whether the first tokens are those of a node or a statement. Comments before them are passed over.
bool begins_as_world(std::string_view text, std::size_t begin) {
  constexpr std::string_view kFirst[] = {"DEF", "PROTO", "EXTERNPROTO"};
  Lexer lexer(text, begin);
  const Token first = lexer.next();
  if (first.kind != TokenKind::kWord) return false;
  const TokenKind second = lexer.next().kind;
  if (second == TokenKind::kOpenBrace) return true;
  return second == TokenKind::kWord && std::ranges::find(kFirst, first.text) != std::end(kFirst);
}

std::unexpected<HeaderError> no_world(std::string why) { return std::unexpected(HeaderError{std::move(why)}); }

// Returns whether the first line is "#X3D V3.0 utf8", with any number of a version 3 or 4.
bool is_x3d_header(std::string_view line) {
  const auto next_word = [&line] {
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    const std::string_view word = line.substr(0, line.find_first_of(" \t"));
    line.remove_prefix(word.size());
    return word;
  };
  if (next_word() != "#X3D") return false;
  const std::string_view version = next_word();
  const bool known = version.size() > 3 && (version.starts_with("V3.") || version.starts_with("V4."));
  return known && version.find_first_not_of("0123456789", 3) == std::string_view::npos && next_word() == "utf8";
}

}  // namespace

std::expected<Header, HeaderError> read_header(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  const std::size_t begin = text.starts_with(kMark) ? kMark.size() : 0;
  const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
  const std::string_view first = text.substr(begin, end - begin);
  // The header is checked for its three words, the blanks between them, and that nothing is glued to the last.
  std::string_view rest = first;
  bool words = true, exact = true;
  for (const std::string_view word : {"#VRML", "V2.0", "utf8"}) {
    words = words && rest.starts_with(word);
    if (!words) break;
    rest.remove_prefix(word.size());
    const std::size_t blanks = std::min(rest.find_first_not_of(" \t"), rest.size());
    if (word != "utf8") {
      words = blanks > 0;
      exact = exact && blanks == 1 && rest[0] == ' ';
    } else {
      words = blanks > 0 || rest.empty();
    }
    rest.remove_prefix(blanks);
  }
  if (words) {
    const std::string_view remark = begin > 0 ? "a byte order mark stands before the header; the standard has none"
                                    : exact   ? std::string_view{}
                                              : "the header's words should be one blank apart: '#VRML V2.0 utf8'";
    return Header{end, remark};
  }
  if (text.empty()) return no_world("the file is empty; a world begins with the line '#VRML V2.0 utf8'");
  if (first.starts_with("#VRML V1.0")) {
    return no_world("this is VRML 1.0, another language; only VRML97 ('#VRML V2.0 utf8') is read");
  }
  if (is_x3d_header(first)) return Header{end, {}, Dialect::kX3dClassic};
  if (first.starts_with("#X3D")) {
    return no_world("this header is none of X3D, which has '#X3D V3.0 utf8' up to '#X3D V4.0 utf8' as its first line");
  }
  const std::size_t solid = text.find_first_not_of(" \t\r\n", begin);
  if (solid != std::string_view::npos && text[solid] == '<') return Header{begin, {}, Dialect::kX3dXml};
  return std::unexpected(
      HeaderError{"the first line must begin with '#VRML V2.0 utf8', exactly so", begin, begins_as_world(text, begin)});
}

std::expected<float, NumberError> read_float(std::string_view text) { return read_real<float>(text); }
std::expected<double, NumberError> read_double(std::string_view text) { return read_real<double>(text); }

std::expected<std::int32_t, NumberError> read_int32(std::string_view text) {
  std::string_view digits = without_plus(text);
  const bool negative = digits.starts_with('-');
  if (negative) digits.remove_prefix(1);
  const bool hexadecimal = digits.starts_with("0x") || digits.starts_with("0X");
  if (hexadecimal) digits.remove_prefix(2);
  std::uint32_t magnitude = 0;
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), magnitude, hexadecimal ? 16 : 10);
  if (error == std::errc::invalid_argument || end != digits.data() + digits.size()) {
    return std::unexpected(NumberError::kSyntax);
  }
  // Hexadecimal digits spell the 32 bits (0xFFFFFFFF is -1, as pixels are written); decimal digits must fit with their
  // sign.
  const std::uint32_t largest = hexadecimal ? 0xFFFFFFFFu : negative ? 0x80000000u : 0x7FFFFFFFu;
  if (error == std::errc::result_out_of_range || magnitude > largest) return std::unexpected(NumberError::kOverflow);
  return static_cast<std::int32_t>(negative ? 0u - magnitude : magnitude);
}

// A mantissa of at most 19 digits fits in 64 bits. With up to 15 digits or a mantissa of 53 bits and a power of ten
// that binary64 holds exactly, one division or multiplication gives the nearest binary64 (Clinger, "How to read
// floating point numbers accurately", 1990); rounding that to binary32 is right too unless it lies just between two of
// them.
const char* scan_plain(const char* begin, const char* end, float& value) {
  constexpr double kPowers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  const char* at = begin;
  const bool negative = at != end && *at == '-';
  if (negative) ++at;
  std::uint64_t mantissa = 0;
  const char* const digits = at;
  for (; at != end && is_digit(*at); ++at) mantissa = 10 * mantissa + static_cast<std::uint64_t>(*at - '0');
  auto count = at - digits;
  std::int64_t exponent = 0;
  if (at != end && *at == '.') {
    const char* const fraction = ++at;
    for (; at != end && is_digit(*at); ++at) mantissa = 10 * mantissa + static_cast<std::uint64_t>(*at - '0');
    exponent = fraction - at;
    count -= exponent;
  }
  if (count == 0 || count > 19) return nullptr;
  if (at != end && (*at == 'e' || *at == 'E')) {
    ++at;
    const bool minus = at != end && *at == '-';
    if (at != end && (*at == '-' || *at == '+')) ++at;
    const char* const power = at;
    std::int64_t written = 0;
    for (; at != end && is_digit(*at); ++at) {
      if (at - power < 5) written = 10 * written + (*at - '0');
    }
    if (at == power || at - power > 4) return nullptr;
    exponent += minus ? -written : written;
  }
  if (at != end && !is(*at, kSpace) && *at != ']' && *at != '}') return nullptr;
  double magnitude = 0;
  if (mantissa != 0) {
    if (mantissa > (std::uint64_t{1} << 53) || exponent < -22 || exponent > 22) return nullptr;
    magnitude = static_cast<double>(mantissa);
    magnitude = exponent < 0 ? magnitude / kPowers[-exponent] : magnitude * kPowers[exponent];
    constexpr std::uint64_t kDropped = (std::uint64_t{1} << 29) - 1, kHalf = std::uint64_t{1} << 28;
    if ((std::bit_cast<std::uint64_t>(magnitude) & kDropped) == kHalf) return nullptr;
    if (!(magnitude >= std::numeric_limits<float>::min() && magnitude <= std::numeric_limits<float>::max())) {
      return nullptr;
    }
  }
  value = static_cast<float>(negative ? -magnitude : magnitude);
  return at;
}

const char* scan_plain(const char* begin, const char* end, std::int32_t& value) {
  const char* at = begin;
  const bool negative = at != end && *at == '-';
  if (negative) ++at;
  const char* const digits = at;
  std::int32_t magnitude = 0;
  for (; at != end && is_digit(*at) && at - digits < 9; ++at) magnitude = 10 * magnitude + (*at - '0');
  if (at == digits || (at != end && !is(*at, kSpace) && *at != ']' && *at != '}')) return nullptr;
  value = negative ? -magnitude : magnitude;
  return at;
}

std::string unescaped(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size() && (text[i + 1] == '"' || text[i + 1] == '\\')) ++i;
    out += text[i];
  }
  return out;
}

bool is_keyword(std::string_view word) {
  constexpr std::string_view kKeywords[] = {"DEF",     "EXTERNPROTO", "FALSE",        "IS",   "NULL",
                                            "PROTO",   "ROUTE",       "TO",           "TRUE", "USE",
                                            "eventIn", "eventOut",    "exposedField", "field"};
  constexpr std::string_view kInitials = "DEFINPRTUef";
  if (word.empty() || kInitials.find(word.front()) == std::string_view::npos) return false;
  return std::ranges::find(kKeywords, word) != std::end(kKeywords);
}

}  // namespace peerd::vrml
