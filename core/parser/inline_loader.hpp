#pragma once
#include <span>
#include <vector>

#include "core/parser/text_state.hpp"

namespace peerd::vrml {

// Loads the files of Inlines (ISO/IEC 14772-1, 6.25) into the world.
class InlineLoader {
 public:
  explicit InlineLoader(TextState& text) : text_(text) {}

  // Gives the node of an Inline the content of its file, unless the Inline is deferred.
  void fill(Node& node);
  // Loads the files of all Inlines in a prototype before a copy of its body comes into the world, so that their nodes
  // stand before those that refer to them. `given` are the fields of the instance.
  void load_all_of(const Prototype& prototype, std::span<const Field> given);

 private:
  [[nodiscard]] bool is_deferred(Position inline_at, const Field* box_size) const;
  const std::vector<NodeRef>* load_content(const Field& url);

  TextState& text_;
};

}  // namespace peerd::vrml
