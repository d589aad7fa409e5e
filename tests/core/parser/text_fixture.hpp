#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "core/parser/text_state.hpp"
#include "core/vrml/default_values.hpp"

namespace peerd::vrml {

// A TextFixture is one text with the state that the parts of its parser share, for tests of a single part. The text
// needs no header. Nodes cannot be read from it: that is the work of a whole TextParser.
class TextFixture {
 public:
  explicit TextFixture(std::string_view text)
      : state(context, OpenText{problems.open({"text.wrl", text, nullptr}).value()}, 0) {
    state.scope = &scope;
  }

  // Returns the messages of all problems so far, warnings too, and empties the list.
  std::vector<std::string> messages() {
    std::vector<std::string> out;
    for (const Diagnostic& d : problems.take().diagnostics) out.push_back(d.message);
    return out;
  }
  // Adds a node of a type of the standard to the world.
  std::uint32_t add_node(std::string_view type) {
    context.world.nodes.push_back({.type = find_node_type(type)});
    return static_cast<std::uint32_t>(context.world.nodes.size() - 1);
  }
  // Adds such a node under a DEF name.
  Definition& define(std::string_view name, std::string_view type) {
    Definition& definition = state.define(name);
    definition.type = find_node_type(type);
    definition.node = add_node(type);
    return definition;
  }

  Document document;
  Problems problems;
  ParseOptions options;
  ParseContext context{.document = document, .problems = problems, .options = options, .parse_text = {}};
  Scope scope{.body = &context.world};
  TextState state;
};

}  // namespace peerd::vrml
