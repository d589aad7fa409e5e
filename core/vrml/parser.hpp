#pragma once
#include <optional>

#include "core/vrml/lexer.hpp"
#include "core/vrml/node_tree.hpp"

namespace peerd::vrml {

// The text behind its header (read_header) to nodes. Reports all problems that it can find in one pass and leaves out
// what it cannot read; the tree stands for the text only where there is no error.
[[nodiscard]] NodeTree parse(std::string_view text, Spot begin, Problems& problems);

// Where the elements of a list of numbers or strings stand. Found by cutting the text again, so that lists need not
// hold the place of each of their numbers.
class ElementSpots {
 public:
  ElementSpots(std::string_view text, const FieldValue& list);
  // Each call asks for the same element as the call before it or for a later one.
  [[nodiscard]] Spot at(std::size_t element);

 private:
  Lexer lexer_;
  Token token_;
  std::size_t element_ = 0;
};

// The default of a field, from the table; none for events.
[[nodiscard]] std::optional<Value> default_value(const FieldSpec& spec);

}  // namespace peerd::vrml
