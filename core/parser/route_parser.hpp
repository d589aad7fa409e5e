#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/parser/text_state.hpp"

namespace peerd::vrml {

// Reads the ROUTEs of one text (ISO/IEC 14772-1, 4.10). A ROUTE becomes part of its body when the scope ends, since the
// nodes that it names must be complete.
class RouteParser {
 public:
  explicit RouteParser(TextState& text) : text_(text) {}

  // Reads a ROUTE from its keyword on.
  void parse();
  // Ends a scope: its ROUTEs become those of its body, and names in the world that stand for no readable node are noted
  // in the document.
  void close(Scope& scope);

 private:
  struct Event {
    const FieldSpec* spec = nullptr;
    // The nodes base + link.node of the scope's body, and their fields; of an instance as many as it has links.
    [[nodiscard]] std::span<const IsLink> links() const { return inner ? *inner : std::span<const IsLink>(&own, 1); }
    std::uint32_t base = 0;
    IsLink own{};
    std::optional<std::span<const IsLink>> inner{};
  };

  std::optional<RouteEnd> parse_end();
  void skip_line_of(const Token& first);
  Event find_event(const RouteEnd& end, bool sends);
  void add_routes(const Scope& scope, const RouteEnd& from, const RouteEnd& to);

  TextState& text_;
};

}  // namespace peerd::vrml
