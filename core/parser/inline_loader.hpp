#pragma once
#include <memory>
#include <span>
#include <vector>

#include "core/parser/text_state.hpp"

namespace peerd::vrml {

// Loads the files of Inlines (ISO/IEC 14772-1, 6.25) into the world.
class InlineLoader {
 public:
  explicit InlineLoader(TextState& text) : text_(text) {}

  // Gives the node of an Inline the content of its file, unless the Inline is deferred. Returns the file, or null.
  const ParseContext::File* fill(Node& node);
  // Loads the files of all Inlines in a prototype before a copy of its body comes into the world, so that their nodes
  // stand before those that refer to them. `given` are the fields of the instance.
  void load_all_of(const Prototype& prototype, std::span<const Field> given);

 private:
  [[nodiscard]] bool is_deferred(Position inline_at, const Field* box_size) const;
  const ParseContext::File* load_content(const Field& url);
  // Adds the nodes of another document to the world, as a scope of their own, and returns those at its top level.
  std::vector<NodeRef> adopt(const std::shared_ptr<const Document>& other, Position at);

  TextState& text_;
};

// Adds a Transform to the world that scales the nodes by a factor.
[[nodiscard]] NodeRef add_scale(TextState& text, double factor, std::span<const NodeRef> nodes);

}  // namespace peerd::vrml
