#pragma once
#include <array>

#include "core/parser/open_nodes.hpp"
#include "core/parser/text_state.hpp"

namespace peerd::vrml {

// Reads IS, which links a field of a node in the body of a PROTO to the interface of that PROTO (ISO/IEC 14772-1, 4.8.3
// and table 4.4).
class LinkParser {
 public:
  LinkParser(TextState& text, OpenNodes& open_nodes) : text_(text), open_nodes_(open_nodes) {}

  // Reads "IS NAME" for the field `spec` of `open`, which stands at `at` and is used with that access. Events of that
  // field that are fields of their own, to it and from it, are linked as well.
  void parse(OpenNode& open, const FieldSpec& spec, Access access, Position at,
             std::array<const FieldSpec*, 2> events = {});

 private:
  TextState& text_;
  const OpenNodes& open_nodes_;
};

}  // namespace peerd::vrml
