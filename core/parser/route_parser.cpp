#include "core/parser/route_parser.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace peerd::vrml {

using enum TokenKind;

void RouteParser::parse() {
  const Token keyword = text_.tokens.take();
  const std::optional<RouteEnd> from = parse_end();
  if (!from && !text_.tokens.at_word("TO")) return skip_line_of(keyword);
  if (!text_.tokens.at_word("TO")) {
    text_.tokens.fault(text_.tokens.position(),
                       "expected TO and where the ROUTE goes, found " + described(text_.tokens.peek()),
                       "the ROUTE is left out");
    return skip_line_of(keyword);
  }
  text_.tokens.take();
  const std::optional<RouteEnd> to = parse_end();
  if (!to) return skip_line_of(keyword);
  if (from && from->node != nullptr && to->node != nullptr) text_.scope->routes.emplace_back(*from, *to);
}

// Passes over a broken ROUTE, which ends with its line, as nearly all do.
void RouteParser::skip_line_of(const Token& first) {
  std::uint32_t seen = first.offset;
  while (text_.tokens.at(kWord) || text_.tokens.at(kPeriod) || text_.tokens.at(kNumber)) {
    const std::string_view text = text_.tokens.text();
    const std::string_view between = text.substr(seen, text_.tokens.peek().offset - seen);
    if (between.find_first_of("\r\n") != std::string_view::npos) return;
    seen = text_.tokens.take().offset;
  }
}

// Reads NODE.EVENT; returns nothing where it is not written so. The node of the result is null where no node has that
// name.
std::optional<RouteEnd> RouteParser::parse_end() {
  const auto expected = [&](const std::string& what) {
    text_.tokens.fault(text_.tokens.position(), "expected " + what + ", found " + described(text_.tokens.peek()),
                       "the ROUTE is left out");
    return std::nullopt;
  };
  RouteEnd end;
  const bool unlawful = text_.tokens.at(kWord) && !text_.at_name() && text_.tokens.kind_after() == kPeriod;
  if (!text_.at_name() && !unlawful) return expected("NODE.EVENT of a ROUTE");
  const Token name = unlawful ? text_.take_unlawful_name("expected NODE.EVENT of a ROUTE") : text_.tokens.take();
  end.name = name.text;
  if (!text_.tokens.accept(kPeriod)) return expected("'.' and an event of " + quoted(name.text));
  if (!text_.tokens.at(kWord) || is_keyword(text_.tokens.peek().text))
    return expected("an event of " + quoted(name.text));
  end.at = text_.tokens.position();
  end.event = text_.tokens.take().text;
  if (Definition* const* const named = text_.scope->names.find(name.text)) {
    end.node = *named;
  } else {
    text_.tokens.fault(text_.tokens.position_of(name),
                       "ROUTE names " + quoted(name.text) + ", which no DEF before it names" +
                           did_you_mean(text_.names_like(name.text)),
                       "the ROUTE is left out");
  }
  return end;
}

// Returns the field that the name of an event stands for: itself, or the exposedField behind set_x and x_changed (4.7).
RouteParser::Event RouteParser::find_event(const RouteEnd& end, bool sends) {
  Definition& definition = *end.node;
  if (definition.type == nullptr || definition.node == NodeRef::kNull) {
    text_.report_lost(definition, end.name, end.at);
    return {};
  }
  const NodeType& type = *definition.type;
  const auto serves = [&](const FieldSpec& field) {
    return sends ? sends_events(field.access) : takes_events(field.access);
  };
  const FieldSpec* found = nullptr;
  const FieldSpec* exact = text_.field_of(type, end.event);
  if (exact != nullptr && exact->access == Access::kContent) exact = nullptr;
  if (exact != nullptr && serves(*exact)) {
    found = exact;
  } else {
    // The parts set_ and _changed may be left out, and an exposedField has both (4.7, 4.10.2).
    std::string_view base;
    if (sends && end.event.ends_with("_changed")) base = end.event.substr(0, end.event.size() - 8);
    if (!sends && end.event.starts_with("set_")) base = end.event.substr(4);
    const FieldSpec* field = base.empty() ? nullptr : text_.field_of(type, base);
    const bool other = text_.is_x3d && find_extra_field(type.name, end.event) != nullptr;  // LOD's level_changed
    if (field != nullptr && field->access == Access::kExposedField && !other) found = field;
    const bool in_script = text_.is_x3d && type.role == NodeRole::kScript;  // whose inputOutput x is three fields
    if ((exact == nullptr || in_script) && found == nullptr) {
      field = find_field(type, sends ? std::string(end.event) + "_changed" : "set_" + std::string(end.event));
      if (field != nullptr && serves(*field)) found = field;
    }
  }
  if (found == nullptr &&
      (text_.unkept_field_of(type, end.event) != nullptr || text_.context.unkept_fields.contains({&type, end.event}))) {
    text_.tokens.warning(end.at, quoted(end.event) + " of " + std::string(type.name) +
                                     " is a field of X3D that is not kept; the ROUTE is left out");
    return {};
  }
  if (found == nullptr) {
    std::string why;
    if (exact != nullptr) {
      why = quoted(end.event) + " is an " + text_.name_of(exact->access) + " of " + std::string(type.name);
      if (exact->access == Access::kField && !text_.is_x3d) why.replace(why.find(" is an "), 7, " is a ");
      why += sends ? ": it sends no events" : ": it takes no events";
    } else {
      Suggestion suggestion(end.event);
      for (const FieldSpec& field : type.fields) {
        if (serves(field)) suggestion.consider(field.name);
      }
      why = std::string(type.name) + (sends ? " sends no event " : " takes no event ") + quoted(end.event) +
            did_you_mean(suggestion);
    }
    text_.tokens.fault(end.at, why, "the ROUTE is left out");
    return {};
  }
  if (definition.prototype == nullptr || definition.prototype->not_found != nullptr) {
    return {.spec = found, .own = {.node = definition.node, .inner = found}};
  }
  return {.spec = found, .base = definition.base, .inner = links_of(definition.prototype->event_links, *found)};
}

void RouteParser::add_routes(const Scope& scope, const RouteEnd& from, const RouteEnd& to) {
  const Event source = find_event(from, true);
  const Event target = find_event(to, false);
  if (source.spec == nullptr || target.spec == nullptr) return;
  if (source.spec->type != target.spec->type) {
    text_.tokens.fault(to.at,
                       "this ROUTE goes from " + std::string(name_of(source.spec->type)) + " to " +
                           std::string(name_of(target.spec->type)) + ": both must be of one type",
                       "the ROUTE is left out");
    return;
  }
  for (const IsLink& out : source.links()) {
    if (!sends_events(out.inner->access)) continue;
    for (const IsLink& in : target.links()) {
      if (!takes_events(in.inner->access)) continue;
      if (!text_.context.room_for(0, 2, from.at)) return;
      scope.body->routes.push_back({source.base + out.node, target.base + in.node, out.inner, in.inner, from.at});
    }
  }
}

void RouteParser::close(Scope& scope) {
  for (const auto& [from, to] : scope.routes) add_routes(scope, from, to);
  const bool lost =
      std::ranges::any_of(scope.definitions, [](const Definition& d) { return d.node == NodeRef::kNull; });
  if (!text_.in_world_body() || !lost) return;
  for (const auto& [name, definition] : scope.names.table()) {
    if (definition->node == NodeRef::kNull) text_.context.document.unreadable_names.push_back(text_.arena.copy(name));
  }
}

}  // namespace peerd::vrml
