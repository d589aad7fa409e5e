#pragma once
#include <string>
#include <string_view>

#include "core/parser/interface_parser.hpp"
#include "core/parser/open_nodes.hpp"
#include "core/parser/route_parser.hpp"
#include "core/parser/type_finder.hpp"

namespace peerd::vrml {

// Reads PROTO and EXTERNPROTO statements (ISO/IEC 14772-1, 4.8 and 4.9) and declares them in the current scope.
class PrototypeParser {
 public:
  PrototypeParser(TextState& text, OpenNodes& open_nodes, RouteParser& routes, TypeFinder& types, Grammar& grammar)
      : text_(text),
        open_nodes_(open_nodes),
        routes_(routes),
        types_(types),
        grammar_(grammar),
        interfaces_(text, routes) {}

  // Both read their statement from the keyword on.
  void parse_proto();
  void parse_externproto();

 private:
  void check_name(const Token& name);
  void skip_declaration(const std::string& keyword);
  void parse_body_of(Prototype& prototype, std::string_view name);

  TextState& text_;
  OpenNodes& open_nodes_;
  RouteParser& routes_;
  TypeFinder& types_;
  Grammar& grammar_;
  InterfaceParser interfaces_;
};

}  // namespace peerd::vrml
