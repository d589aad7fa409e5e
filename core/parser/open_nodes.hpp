#pragma once
#include <cstddef>
#include <list>
#include <string_view>
#include <utility>
#include <vector>

#include "core/parser/text_state.hpp"

namespace peerd::vrml {

// An IS that was read in a node which is still open: the place of the inner node is not known yet.
struct PendingLink {
  const FieldSpec* outer;
  const FieldSpec* inner;
  Position at;
};

// A node between its braces.
struct OpenNode {
  const NodeType* type = nullptr;
  OpenNode* outer = nullptr;    // the node around it, or null
  std::size_t first_field = 0;  // first field of this node in OpenNodes::fields
  std::vector<PendingLink> links{};
  // The fields whose value comes by a link, each once. They are few, where links can be many.
  std::vector<const FieldSpec*> linked{};
  // The fields that a Script declares itself. A list keeps them in place, and costs the other nodes nothing.
  std::list<FieldSpec> own_fields{};
  std::vector<std::string_view> unkept_fields{};  // that a Script declares with types that only X3D has
  Definition* definition = nullptr;
  bool damaged = false;
};

// The field of that name which a text can give to the node: one of its type, or one that a Script has declared so far.
[[nodiscard]] const FieldSpec* find_field_of(const TextState& text, const OpenNode& open, std::string_view name);

// The nodes of one text that are open, from the innermost outwards.
struct OpenNodes {
  OpenNode* innermost = nullptr;
  std::vector<Field> fields{};             // fields read so far of all open nodes, innermost last
  std::vector<Definition*> script_uses{};  // open nodes that the Script field in hand names, in order

  // Returns whether a word among values is the name of a field of the innermost node, or a keyword of an interface
  // outside of any node.
  [[nodiscard]] bool is_field(const TextState& text, std::string_view word) const;
  // Passes over a value. The nodes in it belong to no field of a Script.
  void skip_value(TextState& text);
};

}  // namespace peerd::vrml
