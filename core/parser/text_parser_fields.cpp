// TextParser: fields of nodes, IS, what Scripts declare.
#include <algorithm>
#include <utility>

#include "core/parser/text_parser.hpp"

namespace peerd::vrml {

using enum TokenKind;

const FieldSpec* TextParser::find_field_of(const OpenNode& open, std::string_view name) const {
  const FieldSpec* field = find_field(*open.type, name);
  if (field != nullptr) return field->access == Access::kContent ? nullptr : field;
  const auto it = std::ranges::find(open.own_fields, name, &FieldSpec::name);
  return it == open.own_fields.end() ? nullptr : &*it;
}

bool TextParser::is_field_of_open_node(std::string_view word) const {
  if (open_ == nullptr) return find_access(word).has_value();  // in an interface
  return find_field_of(*open_, word) != nullptr ||
         (open_->type->role == NodeRole::kScript && find_access(word).has_value());
}

void TextParser::parse_fields(OpenNode& open) {
  const Position brace = tokens_.position();
  tokens_.take();
  const auto type = [&] { return std::string(open.type->name); };
  while (true) {
    switch (tokens_.peek().kind) {
      case kCloseBrace:
        tokens_.take();
        return;
      case kWord:
        if (open.type->role == NodeRole::kScript && find_access(tokens_.peek().text)) {
          parse_script_declaration(open);
        } else if (!parse_statement()) {
          parse_field(open);
        }
        break;
      case kEnd:
        open.damaged = true;
        tokens_.report_unclosed(brace, type(), '}');
        return;
      case kCloseBracket:
        open.damaged = true;
        tokens_.error(tokens_.position(), "expected a field of " + type() + " or its '}', found ']'");
        if (values_.in_list()) return;
        tokens_.take();
        break;
      default:
        open.damaged = true;
        tokens_.error(tokens_.position(), "expected a field of " + type() + ", found " + described(tokens_.peek()));
        while (tokens_.at(kNumber) || tokens_.at(kString) || tokens_.at(kPeriod)) tokens_.take();
        if (tokens_.at(kOpenBrace) || tokens_.at(kOpenBracket)) skip_balanced();
    }
  }
}

void TextParser::parse_field(OpenNode& open) {
  const Token name = tokens_.take();
  const FieldSpec* spec = find_field_of(open, name.text);
  Access access = spec != nullptr ? spec->access : Access::kField;
  if (spec == nullptr) {
    // An exposedField x has the events set_x and x_changed (4.7).
    const bool in = name.text.starts_with("set_");
    const std::string_view base = in                                ? name.text.substr(4)
                                  : name.text.ends_with("_changed") ? name.text.substr(0, name.text.size() - 8)
                                                                    : std::string_view{};
    spec = find_field_of(open, base);
    if (spec == nullptr || spec->access != Access::kExposedField) return parse_unknown_field(open, name);
    access = in ? Access::kEventIn : Access::kEventOut;
  }
  if (tokens_.at_word("IS")) return parse_is(open, *spec, access, tokens_.position_of(name));
  if (!has_value(access)) {
    open.damaged = true;
    tokens_.error(tokens_.position_of(name), quoted(name.text) + " is an " + std::string(name_of(access)) + " of " +
                                                 std::string(open.type->name) + ": a file cannot give it a value");
    return skip_value();
  }
  const auto same = [&](const Field& f) { return f.spec == spec; };
  if (std::ranges::find(open.linked, spec) != open.linked.end()) {
    tokens_.warning(tokens_.position_of(name), quoted(name.text) + " is given twice; the last IS counts");
  }
  if (std::any_of(fields_.begin() + static_cast<std::ptrdiff_t>(open.first_field), fields_.end(), same)) {
    tokens_.warning(tokens_.position_of(name), quoted(name.text) + " is given twice; the last one counts");
    fields_.erase(std::remove_if(fields_.begin() + static_cast<std::ptrdiff_t>(open.first_field), fields_.end(), same),
                  fields_.end());
  }
  const Position before = tokens_.position();
  if (const std::optional<Field> value = values_.read(*spec)) {
    // Part by part, as it was written just before: a copy of the whole would wait for the parts.
    fields_.emplace_back(spec, value->data, value->count, value->at);
  } else {
    open.damaged = true;
    // What is there instead is part of the same mistake; a word may be the next field.
    if (tokens_.position() == before && (tokens_.at(kString) || tokens_.at(kNumber))) skip_value();
  }
}

// FIELD IS NAME: table 4.4 of the standard says what may be which.
void TextParser::parse_is(OpenNode& open, const FieldSpec& spec, Access access, Position at) {
  const Position is_at = tokens_.position();
  tokens_.take();
  if (!tokens_.at(kWord)) {
    open.damaged = true;
    return tokens_.error(tokens_.position(),
                         "expected a name of the PROTO's interface after IS, found " + described(tokens_.peek()));
  }
  const Token name = tokens_.take();
  const auto refuse = [&](Position where, const std::string& why) {
    open.damaged = true;
    tokens_.error(where, why);
  };
  Prototype* const prototype = scope_->prototype;
  if (prototype == nullptr) return refuse(is_at, "IS belongs inside a PROTO");
  const FieldSpec* outer = find_field(prototype->type, name.text);
  if (outer == nullptr) {
    Suggestion suggestion(name.text);
    for (const FieldSpec& field : prototype->type.fields) suggestion.consider(field.name);
    return refuse(tokens_.position_of(name), "the interface of " + quoted(prototype->type.name) + " has no " +
                                                 quoted(name.text) + did_you_mean(suggestion));
  }
  if (outer->type != spec.type) {
    return refuse(at, quoted(spec.name) + " is " + std::string(name_of(spec.type)) + " and cannot be " +
                          quoted(outer->name) + ", which is " + std::string(name_of(outer->type)));
  }
  const bool value = outer->access == Access::kExposedField && access == Access::kField;
  if (value) {
    tokens_.warning(at, "the field " + quoted(spec.name) + " takes the value of the exposedField " +
                            quoted(outer->name) + ", and no events: the standard wants a field here");
  } else if (outer->access != access && access != Access::kExposedField) {
    return refuse(at, "the " + std::string(name_of(access)) + ' ' + quoted(spec.name) + " cannot be the " +
                          std::string(name_of(outer->access)) + ' ' + quoted(outer->name));
  }
  const bool carries = has_value(access) && has_value(outer->access);
  open.links.push_back({outer, &spec, at});
  if (!carries) return;
  const bool linked = std::ranges::find(open.linked, &spec) != open.linked.end();
  const auto own_fields = std::span(fields_).subspan(open.first_field);
  if (linked || std::ranges::find(own_fields, &spec, &Field::spec) != own_fields.end()) {
    tokens_.warning(at, quoted(spec.name) + " is given twice; the last IS counts");
  }
  if (!linked) open.linked.push_back(&spec);
}

void TextParser::parse_script_declaration(OpenNode& open) {
  const Token keyword = tokens_.take();
  const Access access = *find_access(keyword.text);
  const auto type = tokens_.at(kWord) ? find_field_type(tokens_.peek().text) : std::nullopt;
  if (!type) {
    open.damaged = true;
    tokens_.error(tokens_.position(), "expected a field type, found " + described(tokens_.peek()));
    if (tokens_.at(kWord) && !find_access(tokens_.peek().text)) tokens_.take();
    if (tokens_.at(kWord) && !find_access(tokens_.peek().text)) tokens_.take();
    return skip_value();
  }
  tokens_.take();
  if (!tokens_.at(kWord) || is_keyword(tokens_.peek().text)) {
    open.damaged = true;
    tokens_.error(tokens_.position(), "expected the name of a field, found " + described(tokens_.peek()));
    if (tokens_.at(kWord) && !find_access(tokens_.peek().text)) tokens_.take();
    return has_value(access) ? skip_value() : void();
  }
  const Token name = tokens_.take();
  if (access == Access::kExposedField) {
    open.damaged = true;
    tokens_.error(tokens_.position_of(keyword), "a Script declares fields, eventIns and eventOuts, no exposedFields");
  }
  if (find_field_of(open, name.text) != nullptr) {
    open.damaged = true;
    tokens_.error(tokens_.position_of(name), "this Script has " + quoted(name.text) + " already");
  }
  if (open.own_fields.size() >= kMaxFields) {
    if (!std::exchange(open.damaged, true)) too_many(tokens_.position_of(name));
    return has_value(access) ? skip_value() : void();
  }
  const FieldSpec& spec =
      open.own_fields.emplace_back(FieldSpec{arena_.copy(name.text), *type, access, {}, Range::kAny, kAnyClass});
  if (tokens_.at_word("IS")) return parse_is(open, spec, access, tokens_.position_of(name));
  if (!has_value(access)) return;
  // Scripts in this field's nodes have lists of their own.
  std::vector<Definition*> outer_uses = std::exchange(script_uses_, {});
  if (const std::optional<Field> value = values_.read(spec)) {
    fields_.push_back(*value);
    auto around = script_uses_.begin();
    for (const NodeRef& ref : value->as<NodeRef>().first(script_uses_.empty() ? 0 : value->count)) {
      // The document's arena is ours to write until it is handed over.
      if (ref.index == kOpenNode) scope_->unresolved_refs[*around++].push_back(const_cast<NodeRef*>(&ref));
    }
  } else {
    open.damaged = true;
  }
  script_uses_ = std::move(outer_uses);
}

void TextParser::parse_unknown_field(OpenNode& open, const Token& name) {
  const std::string type(open.type->name);
  if (tokens_.at(kOpenBrace) && find_type(name).type != nullptr) {
    open.damaged = true;
    tokens_.error(tokens_.position_of(name),
                  quoted(name.text) + " is a node; the name of a field of " + type + " is missing before it");
    parse_node_body({}, name, tokens_.position_of(name));
    return;
  }
  Suggestion suggestion(name.text);
  for (const FieldSpec& field : open.type->fields) {
    if (field.access != Access::kContent) suggestion.consider(field.name);
  }
  for (const FieldSpec& field : open.own_fields) suggestion.consider(field.name);
  if (open.type->role == NodeRole::kDisplay && !suggestion.best()) {
    // A browser's own addition, as many have: passed over whole, not read.
    tokens_.warning(tokens_.position_of(name),
                    type + " has no field " + quoted(name.text) + " in VRML97; it is passed over");
    while (tokens_.at_word("DEF") || tokens_.at_word("USE") || tokens_.kind_after() == kOpenBrace) {
      const bool def = tokens_.take().text == "DEF";
      if (def && tokens_.at(kWord)) define_unreadable(tokens_.take().text);
    }
    if (tokens_.at(kOpenBrace)) return skip_balanced();
    return skip_value();
  }
  open.damaged = true;
  tokens_.error(tokens_.position_of(name), type + " has no field " + quoted(name.text) + did_you_mean(suggestion));
  if (tokens_.at_word("IS")) {
    tokens_.take();
    if (tokens_.at(kWord)) tokens_.take();
    return;
  }
  skip_value();
}

}  // namespace peerd::vrml
