#pragma once
#include <span>
#include <string>
#include <string_view>

#include "core/parser/text_state.hpp"

namespace peerd::vrml {

// Finds the node type that a name stands for: a PROTO or EXTERNPROTO of the scopes around, or a node of the standard.
// EXTERNPROTOs are looked for in their files when they are used first (ISO/IEC 14772-1, 4.9).
class TypeFinder {
 public:
  explicit TypeFinder(TextState& text) : text_(text) {}

  struct Type {
    const NodeType* type = nullptr;        // null: there is no such type
    const Prototype* prototype = nullptr;  // null: the type is built in
  };
  [[nodiscard]] Type find(const Token& name);
  // Makes `declaration` stand for one of our own nodes where its name, or a URN among its URLs, says so.
  void add_native(Declaration& declaration, std::string_view name);

 private:
  bool fits(std::span<const FieldSpec> interface, const NodeType& type, Position at);
  void resolve(Declaration& declaration, std::string_view name);
  const Declaration* find_in_library(std::string_view url, Position at, std::string& why);

  TextState& text_;
};

}  // namespace peerd::vrml
