#pragma once
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "core/parser/node_parser.hpp"
#include "core/parser/open_nodes.hpp"
#include "core/parser/prototype_parser.hpp"
#include "core/parser/route_parser.hpp"
#include "core/parser/text_state.hpp"
#include "core/parser/type_finder.hpp"

namespace peerd::vrml {

// Reads one text of a world. The other texts that it names are read on the way, by ParseContext::parse_text.
class TextParser final : private Grammar {
 public:
  // The parameters are those of TextState.
  TextParser(ParseContext& context, const OpenText& text, std::uint32_t nesting);

  // Reads the whole text into `body`. Inlines are loaded where that is the body of the world.
  Declarations parse_text(Body& body);

 private:
  bool parse_statement() override;
  NodeRef parse_node() override { return nodes_.parse_node(); }
  NodeRef parse_node_body(const Token& def, const Token& type_name, Position at) override {
    return nodes_.parse_node_body(def, type_name, at);
  }
  // Reads an IMPORT or an EXPORT of X3D (ISO/IEC 19775-1, 4.4.6) from its keyword on.
  void parse_import();
  void parse_export();
  void close_exports();
  void warn_of_shared_imports();
  std::optional<Token> take_name(std::string_view statement);
  // Puts a Transform around the nodes of the world from `first` on that leads from the file's unit to metres. Its nodes
  // begin at `first_node`.
  void convert_lengths(Body& body, std::size_t first, std::size_t first_node);
  // Reads one node of the value of an SFNode or MFNode, for ValueReader.
  std::optional<NodeRef> parse_node_value(const FieldSpec& spec);

  TextState text_;
  std::vector<std::pair<Position, const ParseContext::File*>> imports_;
  std::vector<std::pair<Token, std::string_view>> exports_;  // names of nodes here, and those for other files
  OpenNodes open_nodes_;
  RouteParser routes_;
  TypeFinder types_;
  PrototypeParser prototypes_;
  NodeParser nodes_;
};

}  // namespace peerd::vrml
