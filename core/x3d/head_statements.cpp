#include "core/x3d/head_statements.hpp"

#include <string>

namespace peerd::vrml {
namespace {

using enum TokenKind;

void take_string(TokenStream& tokens, std::string_view statement) {
  if (tokens.accept(kString)) return;
  tokens.fault(tokens.position(),
               "expected a string in quotes in " + std::string(statement) + ", found " + described(tokens.peek()));
}

void take_unit(TokenStream& tokens, FileUnits& units) {
  const Position at = tokens.position();
  if (!tokens.at(kWord)) {
    return tokens.fault(at, "expected the kind of a UNIT, such as length, found " + described(tokens.peek()));
  }
  const std::string kind(tokens.take().text);
  if (tokens.at(kWord)) tokens.take();  // its name, which is for people
  const auto factor = read_double(tokens.peek().text);
  if (!tokens.at(kNumber) || !factor || !(*factor > 0)) {
    tokens.fault(tokens.position(), "expected the factor of a UNIT, a number > 0, found " + described(tokens.peek()));
    tokens.accept(kNumber);
    return;
  }
  tokens.take();
  if (kind == "length") {
    units.length = *factor;
  } else if (kind == "angle") {
    units.angle = *factor;
  } else if (kind != "mass" && kind != "force") {
    tokens.fault(at, "a UNIT is one of angle, force, length and mass, and not " + vrml::quoted(kind));
  } else if (*factor != 1.0) {
    tokens.warning(at, "the UNIT of " + kind + " has no effect: no field that is kept has that unit");
  }
}

}  // namespace

bool read_head_statement(TokenStream& tokens, FileUnits& units) {
  if (tokens.kind_after() == kOpenBrace) return false;
  if (tokens.at_word("PROFILE") || tokens.at_word("COMPONENT")) {
    const std::string statement(tokens.take().text);
    if (!tokens.at(kWord)) {
      tokens.fault(tokens.position(), "expected a name behind " + statement + ", found " + described(tokens.peek()));
      return true;
    }
    tokens.take();  // the colon and the level of a COMPONENT are glued to its name, or follow it
    if (tokens.at(kWord) && tokens.peek().text.starts_with(':')) tokens.take();
    if (tokens.at(kNumber)) tokens.take();
    return true;
  }
  if (tokens.at_word("META")) {
    tokens.take();
    take_string(tokens, "META");
    take_string(tokens, "META");
    return true;
  }
  if (!tokens.at_word("UNIT")) return false;
  tokens.take();
  take_unit(tokens, units);
  return true;
}

}  // namespace peerd::vrml
