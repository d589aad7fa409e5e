#pragma once
#include <limits>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "core/vrml/diagnostics.hpp"
#include "core/vrml/lexer.hpp"
#include "core/vrml/position_map.hpp"

namespace peerd::vrml {

// A TokenStream gives the tokens of one text with the next one to look at. It reports bytes that are no token and goes
// on behind them; it ends early once there are too many errors.
class TokenStream {
 public:
  // `map` is given where `text` was made of the text at `text_begin`, and leads back to it. It must outlive the stream.
  TokenStream(std::string_view text, Position text_begin, std::size_t begin, Problems& problems,
              const PositionMap* map = nullptr)
      : problems_(problems), lexer_(text, begin, map != nullptr), text_(text), text_begin_(text_begin), map_(map) {
    advance();
  }
  [[nodiscard]] std::string_view text() const { return text_; }

  [[nodiscard]] const Token& peek() {
    if (is_begin()) ::new (&token_) Token(lexer_.next());
    return token_;
  }
  [[nodiscard]] bool at(TokenKind kind) const { return token_.kind == kind; }
  [[nodiscard]] bool at_word(std::string_view word) const {
    return at(TokenKind::kWord) && token_.text.front() == word.front() && token_.text == word;
  }
  [[nodiscard]] Position position() const { return position_of(token_); }
  [[nodiscard]] Position position_of(const Token& token) const {
    return text_begin_ + (map_ == nullptr ? token.offset : map_->original_of(token.offset));
  }
  // Returns the kind of the token after the next one.
  [[nodiscard]] TokenKind kind_after() {
    static_cast<void>(peek());
    Lexer ahead = lexer_;
    return ahead.next().kind;
  }

  Token take() {
    const Token taken = peek();
    advance();
    return taken;
  }
  // Takes the first `size` bytes of the next token, and goes on with what is glued to them.
  void take_part(std::size_t size) {
    lexer_.go_to(token_.offset + size);
    advance();
  }
  bool accept(TokenKind kind);
  void error(Position at, std::string message);
  void warning(Position at, std::string message) { problems_.warning(at, std::move(message)); }
  void fault(Position at, std::string message, std::string_view reading = "it is left out");
  [[nodiscard]] bool lenient() const { return problems_.lenient(); }

  // Takes plain numbers (Lexer::take_numbers) from the next token on.
  template <class T, class Add>
  void take_numbers(Add add, std::size_t most = std::numeric_limits<std::size_t>::max()) {
    lexer_.go_to(token_.offset);
    lexer_.template take_numbers<T>(add, most);
    advance();
  }
  // Returns how many numbers a list may hold, at its '['. It is 0 inside a list that was counted before, so that a text
  // of brackets that never close is not counted over and over.
  [[nodiscard]] std::size_t count_numbers();

  // Returns whether the value that stands here is `value`, which is text, too. Brackets around it do not matter.
  [[nodiscard]] bool at_value(std::string_view value) const;

  // Passes over everything from '{' or '[' to its partner, and returns the names that stand behind a DEF in there.
  std::vector<std::string_view> skip_balanced();
  // Reports once that the part named `what`, opened at `open`, never ends: all parts that are open around it do not end
  // either.
  void report_unclosed(Position open, const std::string& what, char missing);

 private:
  // The token is constructed in place: a copy of an object that was written piece by piece just before would wait for
  // the pieces.
  void advance() {
    ::new (&token_) Token(lexer_.next_begin());
    if (at(TokenKind::kInvalid) || at(TokenKind::kUnterminatedString)) pass_over_invalid();
  }
  // Numbers are mostly taken by take_numbers(): the lexer looks for the end of a number only for callers that use it
  // otherwise.
  [[nodiscard]] bool is_begin() const { return at(TokenKind::kNumber) && token_.text.empty(); }
  void pass_over_invalid();

  Problems& problems_;
  Lexer lexer_;
  Token token_;
  std::string_view text_;
  Position text_begin_;
  const PositionMap* map_;
  std::size_t counted_to_ = 0;
  bool unclosed_reported_ = false;
};

// Returns the name of a token in messages.
[[nodiscard]] std::string described(const Token& token);

}  // namespace peerd::vrml
