#pragma once
#include <optional>

#include "core/parser/field_parser.hpp"
#include "core/parser/inline_loader.hpp"
#include "core/parser/link_parser.hpp"
#include "core/parser/open_nodes.hpp"
#include "core/parser/script_parser.hpp"
#include "core/parser/text_state.hpp"
#include "core/parser/type_finder.hpp"

namespace peerd::vrml {

// Reads nodes and adds them to the body of the current scope: as one node, or as a copy of the body of a PROTO.
class NodeParser {
 public:
  NodeParser(TextState& text, OpenNodes& open_nodes, TypeFinder& types, Grammar& grammar)
      : text_(text),
        open_nodes_(open_nodes),
        types_(types),
        links_(text, open_nodes),
        scripts_(text, open_nodes, links_),
        fields_(text, open_nodes, links_, scripts_, types, grammar),
        inlines_(text) {}

  // Grammar::parse_node() and Grammar::parse_node_body().
  NodeRef parse_node();
  NodeRef parse_node_body(const Token& def, const Token& type_name, Position at);

 private:
  NodeRef parse_use();
  void report_unknown_type(const Token& name);
  // Gives a node of X3D the values that it has by default, as far as VRML97 has others.
  void give_x3d_defaults(const OpenNode& open, Position at);
  NodeRef close_node(OpenNode& open, const Token& def, Position at);
  NodeRef close_instance(OpenNode& open, const Prototype& prototype, const Token& def, Position at);

  TextState& text_;
  OpenNodes& open_nodes_;
  TypeFinder& types_;
  LinkParser links_;
  ScriptParser scripts_;
  FieldParser fields_;
  InlineLoader inlines_;
};

}  // namespace peerd::vrml
