#include "core/parser/link_parser.hpp"

#include <algorithm>
#include <span>
#include <string>

namespace peerd::vrml {

using enum TokenKind;

void LinkParser::parse(OpenNode& open, const FieldSpec& spec, Access access, Position at,
                       std::array<const FieldSpec*, 2> events) {
  const Position is_at = text_.tokens.position();
  text_.tokens.take();
  if (!text_.tokens.at(kWord)) {
    open.damaged = true;
    return text_.tokens.fault(
        text_.tokens.position(),
        "expected a name of the PROTO's interface after IS, found " + described(text_.tokens.peek()),
        "the IS is left out");
  }
  const Token name = text_.tokens.take();
  const auto refuse = [&](Position where, const std::string& why) {
    open.damaged = true;
    text_.tokens.fault(where, why, "the IS is left out");
  };
  Prototype* const prototype = text_.scope->prototype;
  if (prototype == nullptr) return refuse(is_at, "IS belongs inside a PROTO");
  const FieldSpec* outer = find_field(prototype->type, name.text);
  if (outer == nullptr && text_.context.unkept_fields.contains({&prototype->type, name.text})) return;
  if (outer == nullptr) {
    Suggestion suggestion(name.text);
    for (const FieldSpec& field : prototype->type.fields) suggestion.consider(field.name);
    return refuse(text_.tokens.position_of(name), "the interface of " + quoted(prototype->type.name) + " has no " +
                                                      quoted(name.text) + did_you_mean(suggestion));
  }
  if (outer->type != spec.type) {
    return refuse(at, quoted(spec.name) + " is " + std::string(name_of(spec.type)) + " and cannot be " +
                          quoted(outer->name) + ", which is " + std::string(name_of(outer->type)));
  }
  const bool value = outer->access == Access::kExposedField && access == Access::kField;
  if (value) {
    text_.tokens.warning(at, "the " + text_.name_of(access) + ' ' + quoted(spec.name) + " takes the value of the " +
                                 text_.name_of(outer->access) + ' ' + quoted(outer->name) +
                                 ", and no events: the standard wants " +
                                 (text_.is_x3d ? "an initializeOnly here" : "a field here"));
  } else if (outer->access != access && access != Access::kExposedField) {
    return refuse(at, "the " + text_.name_of(access) + ' ' + quoted(spec.name) + " cannot be the " +
                          text_.name_of(outer->access) + ' ' + quoted(outer->name));
  }
  const bool carries = has_value(access) && has_value(outer->access);
  open.links.push_back({outer, &spec, at});
  if (events[0] != nullptr && takes_events(outer->access)) open.links.push_back({outer, events[0], at});
  if (events[1] != nullptr && sends_events(outer->access)) open.links.push_back({outer, events[1], at});
  if (!carries) return;
  const bool linked = std::ranges::find(open.linked, &spec) != open.linked.end();
  const auto own_fields = std::span(open_nodes_.fields).subspan(open.first_field);
  if (linked || std::ranges::find(own_fields, &spec, &Field::spec) != own_fields.end()) {
    text_.tokens.warning(at, quoted(spec.name) + " is given twice; the last IS counts");
  }
  if (!linked) open.linked.push_back(&spec);
}

}  // namespace peerd::vrml
