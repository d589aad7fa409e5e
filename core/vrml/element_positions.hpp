#pragma once
#include <cassert>
#include <string_view>

#include "core/vrml/document.hpp"
#include "core/vrml/lexer.hpp"

namespace peerd::vrml {

// ElementPositions finds where the elements of a value of numbers or strings stand. It cuts the text again, so that
// lists need not hold the place of each of their numbers.
class ElementPositions {
 public:
  ElementPositions(std::string_view text, Position text_begin, Position value)
      : begin_(text_begin), lexer_(text, value - text_begin), token_(lexer_.next()) {
    if (token_.kind == TokenKind::kOpenBracket) token_ = lexer_.next();
  }
  // A call asks for the same element as the call before it or for a later one.
  [[nodiscard]] Position at(std::size_t element) {
    go_to(element);
    return begin_ + token_.offset;
  }
  [[nodiscard]] std::string_view text_at(std::size_t element) {
    go_to(element);
    return token_.text;
  }

 private:
  void go_to(std::size_t element) {
    assert(element >= element_);
    for (; element_ < element; ++element_) token_ = lexer_.next();
  }

  Position begin_;
  Lexer lexer_;
  Token token_;
  std::size_t element_ = 0;
};

}  // namespace peerd::vrml
