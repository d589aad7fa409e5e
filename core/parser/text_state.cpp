#include "core/parser/text_state.hpp"

#include <algorithm>
#include <string>

namespace peerd::vrml {

Definition& TextState::define(std::string_view name) {
  scope->definitions.emplace_back();
  scope->names.set(name, &scope->definitions.back());
  return scope->definitions.back();
}

void TextState::define_unreadable(std::string_view name) {
  if (!name.empty()) define(name);
}

void TextState::define_unreadable(const std::vector<std::string_view>& names) {
  for (const std::string_view name : names) define_unreadable(name);
}

bool TextState::at_name() { return tokens.at(TokenKind::kWord) && !is_keyword(tokens.peek().text); }

bool TextState::at_unlawful_name() {
  return tokens.at(TokenKind::kNumber) || (tokens.at(TokenKind::kWord) && is_keyword(tokens.peek().text));
}

Token TextState::take_unlawful_name(const std::string& expected) {
  const Position at = tokens.position();
  Token name = tokens.take();
  std::string read_as = "_" + std::string(name.text);
  std::ranges::replace_if(
      read_as, [](char c) { return c == '.' || c == '#'; }, '_');
  tokens.fault(at, expected + ", found " + described(name), "it is read as " + quoted(read_as));
  name.text = arena.copy(std::string_view(read_as));
  return name;
}

Suggestion TextState::names_like(std::string_view name) const {
  Suggestion suggestion(name);
  std::vector<std::string_view> names;  // in an order that doesn't depend on where they stand
  if (scope->names.table().size() <= kMaxSuggestionNames) {
    for (const auto& [known, definition] : scope->names.table()) names.push_back(known);
  }
  std::ranges::sort(names);
  for (const std::string_view known : names) suggestion.consider(known);
  return suggestion;
}

void TextState::report_too_many_fields(Position at) {
  tokens.error(at,
               "with this field there are more than " + std::to_string(kMaxFields) + ", more than this reader takes");
}

}  // namespace peerd::vrml
