#pragma once
#include "core/parser/link_parser.hpp"
#include "core/parser/open_nodes.hpp"
#include "core/parser/script_parser.hpp"
#include "core/parser/text_state.hpp"
#include "core/parser/type_finder.hpp"

namespace peerd::vrml {

// Reads the fields of a node.
class FieldParser {
 public:
  FieldParser(TextState& text, OpenNodes& open_nodes, LinkParser& links, ScriptParser& scripts, TypeFinder& types,
              Grammar& grammar)
      : text_(text), open_nodes_(open_nodes), links_(links), scripts_(scripts), types_(types), grammar_(grammar) {}

  // Reads everything from the '{' of the node to its '}', into OpenNodes::fields and into `open`.
  void parse(OpenNode& open);

 private:
  void parse_field(OpenNode& open);
  void parse_unknown_field(OpenNode& open, const Token& name);
  // Passes over the field of X3D that stands behind its name, and warns where what it says is lost.
  void pass_over(const OpenNode& open, const ExtraField& field, const Token& name);
  // Passes over the value of a field without reading it.
  void pass_over_value();

  TextState& text_;
  OpenNodes& open_nodes_;
  LinkParser& links_;
  ScriptParser& scripts_;
  TypeFinder& types_;
  Grammar& grammar_;
};

}  // namespace peerd::vrml
