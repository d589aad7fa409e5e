#include "core/vrml/token_stream.hpp"

#include <cassert>
#include <utility>

namespace peerd::vrml {

using enum TokenKind;

std::string described(const Token& token) {
  switch (token.kind) {
    case kEnd:
      return "the end of the file";
    case kString:
    case kUnterminatedString:
      return "the string \"" + quoted(token.text).substr(1);
    default:
      return quoted(token.text);
  }
}

void TokenStream::pass_over_invalid() {
  while (token_.kind == kInvalid || token_.kind == kUnterminatedString) {
    const bool string = token_.kind == kUnterminatedString;
    if (string) {
      error(position(), "this string is never closed: a '\"' is missing");
    } else {
      fault(position(), quoted(token_.text) + " cannot stand here: no VRML token contains it");
    }
    token_ = lexer_.next();
  }
}

bool TokenStream::accept(TokenKind kind) {
  if (token_.kind != kind) return false;
  take();
  return true;
}

void TokenStream::error(Position at, std::string message) {
  problems_.error(at, std::move(message));
  if (problems_.full()) lexer_.stop();
}

void TokenStream::fault(Position at, std::string message, std::string_view reading) {
  problems_.fault(at, std::move(message), reading);
  if (problems_.full()) lexer_.stop();
}

std::size_t TokenStream::count_numbers() {
  assert(at(kOpenBracket));
  if (lexer_.offset() < counted_to_) return 0;
  const Lexer::Count count = lexer_.count_numbers();
  counted_to_ = count.end;
  return count.numbers;
}

bool TokenStream::at_value(std::string_view value) const {
  Lexer here = lexer_, wanted(value);
  here.go_to(token_.offset);
  Token mine = here.next(), other = wanted.next();
  const bool bracketed = mine.kind == kOpenBracket;
  if (bracketed) mine = here.next();
  if (!bracketed && other.kind == kEnd) return false;
  while (other.kind != kEnd) {
    const auto number = read_double(mine.text), expected_number = read_double(other.text);
    const bool same =
        mine.kind == kNumber && number && expected_number ? *number == *expected_number : mine.text == other.text;
    if (mine.kind != other.kind || !same) return false;
    mine = here.next();
    other = wanted.next();
  }
  return bracketed ? mine.kind == kCloseBracket : mine.kind != kNumber && mine.kind != kString;
}

void TokenStream::report_unclosed(Position open, const std::string& what, char missing) {
  if (!std::exchange(unclosed_reported_, true)) {
    error(open,
          "this " + what + " is never closed" + (missing == 0 ? "" : std::string(": a '") + missing + "' is missing"));
  }
}

std::vector<std::string_view> TokenStream::skip_balanced() {
  assert(at(kOpenBrace) || at(kOpenBracket));
  const Token open = token_;
  std::vector<std::string_view> names;
  std::size_t depth = 0;
  do {
    if (at(kEnd)) {
      report_unclosed(position_of(open), described(open), 0);
      return names;
    }
    if (at(kOpenBrace) || at(kOpenBracket)) ++depth;
    if (at(kCloseBrace) || at(kCloseBracket)) --depth;
    const bool def = take().text == "DEF";
    if (def && at(kWord)) names.push_back(token_.text);
  } while (depth > 0);
  return names;
}

}  // namespace peerd::vrml
