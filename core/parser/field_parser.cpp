#include "core/parser/field_parser.hpp"

#include <algorithm>
#include <optional>
#include <string>

namespace peerd::vrml {

using enum TokenKind;

void FieldParser::parse(OpenNode& open) {
  const Position brace = text_.tokens.position();
  text_.tokens.take();
  const auto type = [&] { return std::string(open.type->name); };
  while (true) {
    switch (text_.tokens.peek().kind) {
      case kCloseBrace:
        text_.tokens.take();
        return;
      case kWord:
        if (open.type->role == NodeRole::kScript && text_.access_of(text_.tokens.peek().text)) {
          scripts_.parse_declaration(open);
        } else if (!grammar_.parse_statement()) {
          parse_field(open);
        }
        break;
      case kEnd:
        open.damaged = true;
        text_.tokens.report_unclosed(brace, type(), '}');
        return;
      case kCloseBracket:
        open.damaged = true;
        text_.tokens.fault(text_.tokens.position(), "expected a field of " + type() + " or its '}', found ']'");
        if (text_.values.in_list()) return;
        text_.tokens.take();
        break;
      default:
        open.damaged = true;
        text_.tokens.fault(text_.tokens.position(),
                           "expected a field of " + type() + ", found " + described(text_.tokens.peek()));
        while (text_.tokens.at(kNumber) || text_.tokens.at(kString) || text_.tokens.at(kPeriod)) text_.tokens.take();
        if (text_.tokens.at(kOpenBrace) || text_.tokens.at(kOpenBracket)) text_.skip_balanced();
    }
  }
}

void FieldParser::parse_field(OpenNode& open) {
  const Token name = text_.tokens.take();
  const FieldSpec* spec = find_field_of(text_, open, name.text);
  Access access = spec != nullptr ? spec->access : Access::kField;
  if (spec == nullptr) {
    // An exposedField x has the events set_x and x_changed (4.7).
    const bool in = name.text.starts_with("set_");
    const std::string_view base = in                                ? name.text.substr(4)
                                  : name.text.ends_with("_changed") ? name.text.substr(0, name.text.size() - 8)
                                                                    : std::string_view{};
    spec = find_field_of(text_, open, base);
    if (spec == nullptr || spec->access != Access::kExposedField) return parse_unknown_field(open, name);
    access = in ? Access::kEventIn : Access::kEventOut;
  }
  if (text_.tokens.at_word("IS")) return links_.parse(open, *spec, access, text_.tokens.position_of(name));
  if (!has_value(access)) {
    open.damaged = true;
    text_.tokens.fault(text_.tokens.position_of(name),
                       quoted(name.text) + " is an " + text_.name_of(access) + " of " + std::string(open.type->name) +
                           ": a file cannot give it a value",
                       "the value is left out");
    return open_nodes_.skip_value(text_);
  }
  const auto same = [&](const Field& f) { return f.spec == spec; };
  if (std::ranges::find(open.linked, spec) != open.linked.end()) {
    text_.tokens.warning(text_.tokens.position_of(name), quoted(name.text) + " is given twice; the last IS counts");
  }
  if (std::any_of(open_nodes_.fields.begin() + static_cast<std::ptrdiff_t>(open.first_field), open_nodes_.fields.end(),
                  same)) {
    text_.tokens.warning(text_.tokens.position_of(name), quoted(name.text) + " is given twice; the last one counts");
    open_nodes_.fields.erase(std::remove_if(open_nodes_.fields.begin() + static_cast<std::ptrdiff_t>(open.first_field),
                                            open_nodes_.fields.end(), same),
                             open_nodes_.fields.end());
  }
  const Position before = text_.tokens.position();
  if (std::optional<Field> value = text_.values.read(*spec)) {
    text_.convert_angles(*open.type, *value);
    // The field is constructed part by part, as it was written just before: a copy of the whole would wait for the
    // parts.
    open_nodes_.fields.emplace_back(spec, value->data, value->count, value->at);
  } else {
    open.damaged = true;
    // A token that stands in place of the value is part of the same mistake; a word may be the next field.
    if (text_.tokens.position() == before && (text_.tokens.at(kString) || text_.tokens.at(kNumber)))
      open_nodes_.skip_value(text_);
  }
}

void FieldParser::pass_over_value() {
  if (text_.tokens.at_word("USE")) {
    text_.tokens.take();
    if (text_.tokens.at(kWord)) text_.tokens.take();
    return;
  }
  if (text_.tokens.at_word("DEF")) {
    text_.tokens.take();
    if (text_.tokens.at(kWord)) text_.define_unreadable(text_.tokens.take().text);
  }
  if (text_.tokens.at(kWord) && text_.tokens.kind_after() == kOpenBrace) text_.tokens.take();
  if (text_.tokens.at(kOpenBrace) || text_.tokens.at(kOpenBracket)) return text_.skip_balanced();
  open_nodes_.skip_value(text_);
}

void FieldParser::pass_over(const OpenNode& open, const ExtraField& field, const Token& name) {
  const Position at = text_.tokens.position_of(name);
  const std::string what = quoted(name.text) + " of " + std::string(open.type->name);
  if (text_.tokens.at_word("IS")) {
    text_.tokens.take();
    if (text_.tokens.at(kWord)) text_.tokens.take();
    return text_.tokens.warning(at, what + " is a field of X3D that is not kept; the IS is left out");
  }
  const bool default_value = text_.tokens.at_value(field.default_value);
  if (field.field == "metadata") {
    if (!default_value) text_.report_metadata(at);
  } else if (!default_value) {
    text_.tokens.warning(at, what + " is a field of X3D that is not kept; its value has no effect");
  }
  pass_over_value();
}

void FieldParser::parse_unknown_field(OpenNode& open, const Token& name) {
  const std::string type(open.type->name);
  const ExtraField* const extra = text_.unkept_field_of(*open.type, name.text);
  if (extra != nullptr && (!extra->is_event() || text_.tokens.at_word("IS"))) return pass_over(open, *extra, name);
  if (text_.context.unkept_fields.contains({open.type, name.text})) return pass_over_value();
  if (text_.tokens.at(kOpenBrace) && types_.find(name).type != nullptr) {
    open.damaged = true;
    text_.tokens.fault(text_.tokens.position_of(name),
                       quoted(name.text) + " is a node; the name of a field of " + type + " is missing before it",
                       "the node is left out");
    grammar_.parse_node_body({}, name, text_.tokens.position_of(name));
    return;
  }
  Suggestion suggestion(name.text);
  for (const FieldSpec& field : open.type->fields) {
    if (field.access != Access::kContent) suggestion.consider(field.name);
  }
  for (const FieldSpec& field : open.own_fields) suggestion.consider(field.name);
  if (open.type->role == NodeRole::kDisplay && !suggestion.best()) {
    // A field that a browser has added, as many files have them, is passed over whole, not read.
    text_.tokens.warning(text_.tokens.position_of(name), type + " has no field " + quoted(name.text) + " in " +
                                                             (text_.is_x3d ? "X3D" : "VRML97") + "; it is passed over");
    return pass_over_value();
  }
  open.damaged = true;
  text_.tokens.fault(text_.tokens.position_of(name),
                     type + " has no field " + quoted(name.text) + did_you_mean(suggestion), "the field is left out");
  if (text_.tokens.at_word("IS")) {
    text_.tokens.take();
    if (text_.tokens.at(kWord)) text_.tokens.take();
    return;
  }
  open_nodes_.skip_value(text_);
}

}  // namespace peerd::vrml
