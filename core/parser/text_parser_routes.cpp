// TextParser: ROUTE, and the end of a scope, where its ROUTEs are known.
#include <algorithm>
#include <utility>

#include "core/parser/text_parser.hpp"

namespace peerd::vrml {

using enum TokenKind;

void TextParser::parse_route() {
  const Token keyword = tokens_.take();
  const std::optional<RouteEnd> from = parse_route_end();
  if (!from && !tokens_.at_word("TO")) return skip_line_of(keyword);
  if (!tokens_.at_word("TO")) {
    tokens_.error(tokens_.position(), "expected TO and where the ROUTE goes, found " + described(tokens_.peek()));
    return skip_line_of(keyword);
  }
  tokens_.take();
  const std::optional<RouteEnd> to = parse_route_end();
  if (!to) return skip_line_of(keyword);
  if (from && from->node != nullptr && to->node != nullptr) scope_->routes.emplace_back(*from, *to);
}

// A broken ROUTE ends with its line, as nearly all do.
void TextParser::skip_line_of(const Token& first) {
  std::uint32_t seen = first.offset;
  while (tokens_.at(kWord) || tokens_.at(kPeriod) || tokens_.at(kNumber)) {
    const std::string_view text = problems_.text_of(tokens_.position());
    const std::string_view between = text.substr(seen, tokens_.peek().offset - seen);
    if (between.find_first_of("\r\n") != std::string_view::npos) return;
    seen = tokens_.take().offset;
  }
}

// NODE.EVENT; nothing where it is not written so. Its node is null where no node has that name.
std::optional<RouteEnd> TextParser::parse_route_end() {
  const auto expected = [&](const std::string& what) {
    tokens_.error(tokens_.position(), "expected " + what + ", found " + described(tokens_.peek()));
    return std::nullopt;
  };
  RouteEnd end;
  if (!tokens_.at(kWord) || is_keyword(tokens_.peek().text)) return expected("NODE.EVENT of a ROUTE");
  const Token name = tokens_.take();
  end.name = name.text;
  if (!tokens_.accept(kPeriod)) return expected("'.' and an event of " + quoted(name.text));
  if (!tokens_.at(kWord) || is_keyword(tokens_.peek().text)) return expected("an event of " + quoted(name.text));
  end.at = tokens_.position();
  end.event = tokens_.take().text;
  if (Definition* const* const named = scope_->names.find(name.text)) {
    end.node = *named;
  } else {
    tokens_.error(tokens_.position_of(name), "ROUTE names " + quoted(name.text) + ", which no DEF before it names" +
                                                 did_you_mean(names_like(name.text)));
  }
  return end;
}

// Of the names in force here the one that was probably meant.
Suggestion TextParser::names_like(std::string_view name) const {
  Suggestion suggestion(name);
  std::vector<std::string_view> names;  // in an order that doesn't depend on where they stand
  if (scope_->names.table().size() <= kMaxSuggestionNames) {
    for (const auto& [known, definition] : scope_->names.table()) names.push_back(known);
  }
  std::ranges::sort(names);
  for (const std::string_view known : names) suggestion.consider(known);
  return suggestion;
}

// The field that an event's name stands for: itself, or the exposedField behind set_x and x_changed (4.7).
TextParser::Event TextParser::find_event(const RouteEnd& end, bool sends) {
  const Definition& definition = *end.node;
  if (definition.type == nullptr || definition.node == NodeRef::kNull) return {};  // what was lost is reported
  const NodeType& type = *definition.type;
  const auto serves = [&](const FieldSpec& field) {
    return sends ? sends_events(field.access) : takes_events(field.access);
  };
  const FieldSpec* found = nullptr;
  const FieldSpec* exact = find_field(type, end.event);
  if (exact != nullptr && exact->access == Access::kContent) exact = nullptr;
  if (exact != nullptr && serves(*exact)) {
    found = exact;
  } else {
    // set_ and _changed may be left out, and an exposedField has both (4.7, 4.10.2).
    std::string_view base;
    if (sends && end.event.ends_with("_changed")) base = end.event.substr(0, end.event.size() - 8);
    if (!sends && end.event.starts_with("set_")) base = end.event.substr(4);
    const FieldSpec* field = base.empty() ? nullptr : find_field(type, base);
    if (field != nullptr && field->access == Access::kExposedField) found = field;
    if (exact == nullptr && found == nullptr) {
      field = find_field(type, sends ? std::string(end.event) + "_changed" : "set_" + std::string(end.event));
      if (field != nullptr && serves(*field)) found = field;
    }
  }
  if (found == nullptr) {
    std::string why;
    if (exact != nullptr) {
      why = quoted(end.event) + " is an " + std::string(name_of(exact->access)) + " of " + std::string(type.name);
      if (exact->access == Access::kField) why.replace(why.find(" is an "), 7, " is a ");
      why += sends ? ": it sends no events" : ": it takes no events";
    } else {
      Suggestion suggestion(end.event);
      for (const FieldSpec& field : type.fields) {
        if (serves(field)) suggestion.consider(field.name);
      }
      why = std::string(type.name) + (sends ? " sends no event " : " takes no event ") + quoted(end.event) +
            did_you_mean(suggestion);
    }
    tokens_.error(end.at, why);
    return {};
  }
  if (definition.prototype == nullptr || definition.prototype->not_found != nullptr) {
    return {.spec = found, .own = {.node = definition.node, .inner = found}};
  }
  return {.spec = found, .base = definition.base, .inner = links_of(definition.prototype->event_links, *found)};
}

void TextParser::add_routes(const Scope& scope, const RouteEnd& from, const RouteEnd& to) {
  const Event source = find_event(from, true);
  const Event target = find_event(to, false);
  if (source.spec == nullptr || target.spec == nullptr) return;
  if (source.spec->type != target.spec->type) {
    tokens_.error(to.at, "this ROUTE goes from " + std::string(name_of(source.spec->type)) + " to " +
                             std::string(name_of(target.spec->type)) + ": both must be of one type");
    return;
  }
  for (const IsLink& out : source.links()) {
    for (const IsLink& in : target.links()) {
      if (!context_.room_for(0, 2, from.at)) return;
      scope.body->routes.push_back({source.base + out.node, target.base + in.node, out.inner, in.inner, from.at});
    }
  }
}

void TextParser::close(Scope& scope) {
  for (const auto& [from, to] : scope.routes) add_routes(scope, from, to);
  const bool lost =
      std::ranges::any_of(scope.definitions, [](const Definition& d) { return d.node == NodeRef::kNull; });
  if (!in_world_body() || !lost) return;
  for (const auto& [name, definition] : scope.names.table()) {
    if (definition->node == NodeRef::kNull) context_.document.unreadable_names.push_back(arena_.copy(name));
  }
}

}  // namespace peerd::vrml
