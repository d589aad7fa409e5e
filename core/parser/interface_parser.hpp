#pragma once
#include <optional>
#include <string_view>
#include <utility>

#include "core/parser/route_parser.hpp"
#include "core/parser/text_state.hpp"

namespace peerd::vrml {

// Reads the interface of a PROTO or an EXTERNPROTO: the declarations between '[' and ']' (ISO/IEC 14772-1, 4.8.2).
class InterfaceParser {
 public:
  InterfaceParser(TextState& text, RouteParser& routes) : text_(text), routes_(routes) {}

  // Reads the interface of the PROTO `name` into `prototype`, with default values if `with_values`. The declarations
  // that can be read are kept. Returns whether all could.
  bool parse(std::string_view name, bool with_values, Prototype& prototype);

 private:
  std::optional<std::pair<FieldType, Token>> parse_type_and_name();
  std::optional<Field> parse_default(const FieldSpec& spec, Prototype& prototype);
  void skip_to_declaration();
  // Passes over a declaration of a type that only X3D has, and says so, if one stands here behind its access.
  bool skip_unkept(Prototype& prototype, bool has_default);

  TextState& text_;
  RouteParser& routes_;
};

}  // namespace peerd::vrml
