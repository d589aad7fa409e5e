#pragma once
#include <array>

#include "core/parser/link_parser.hpp"
#include "core/parser/open_nodes.hpp"
#include "core/parser/text_state.hpp"

namespace peerd::vrml {

// Reads the interface that a Script declares inside its braces (ISO/IEC 14772-1, 4.12 and 6.40).
class ScriptParser {
 public:
  ScriptParser(TextState& text, OpenNodes& open_nodes, LinkParser& links)
      : text_(text), open_nodes_(open_nodes), links_(links) {}

  // Reads one declaration from its keyword on.
  void parse_declaration(OpenNode& open);
  // Gives the Script a type of its own, with the fields of every Script and those that it has declared.
  void finish(OpenNode& open, Position at);

 private:
  void complete_values(OpenNode& open, Position at);
  std::array<const FieldSpec*, 2> add_events(OpenNode& open, const FieldSpec& field);

  TextState& text_;
  OpenNodes& open_nodes_;
  LinkParser& links_;
};

}  // namespace peerd::vrml
