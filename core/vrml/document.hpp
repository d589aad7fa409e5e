#pragma once
#include <cassert>
#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "core/lasting_ids.hpp"
#include "core/vrml/arena.hpp"
#include "core/vrml/diagnostics.hpp"
#include "core/vrml/node_types.hpp"

namespace peerd::vrml {

// The deepest nesting of nodes inside nodes, in the text or through USE. Deeper input is refused; the reader recurses
// this far.
inline constexpr std::uint32_t kMaxNesting = 256;

// A NodeRef is a node where it stands: written there, or USEd there.
struct NodeRef {
  static constexpr std::uint32_t kNull = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t index = kNull;  // into Document::nodes
  Position at = 0;

  [[nodiscard]] bool is_node() const { return index != kNull; }
};

// A Field is the value of a field, in the arena of the document and never changed there: copies of a node share it. The
// elements by type: bool | std::int32_t (SFImage: width, height, components, pixels) | double (SFTime) | float, flat |
// std::string_view | NodeRef (SFNode: none where it is NULL). An SF value is a list of one.
struct Field {
  const FieldSpec* spec = nullptr;
  const void* data = nullptr;
  std::uint32_t count = 0;  // number of elements
  Position at = 0;          // position of the first token of the value

  template <class T>
  [[nodiscard]] std::span<const T> as() const {
    return {static_cast<const T*>(data), count};
  }
};

struct Node {
  const NodeType* type = nullptr;
  const Field* fields = nullptr;  // fields that the text gives; default_of() has the others
  std::string_view def{};
  Position at = 0;
  // The scope of the names that are seen from the node: those of the world are 0, each copy of the body of a PROTO and
  // each Inline has its own.
  std::uint32_t scope = 0;
  std::uint32_t source = 0;  // of an edited document: where its name and values are, into Document::sources
  std::uint32_t field_count = 0;
  bool damaged = false;  // an error inside it is reported: what follows from it needs no second report

  [[nodiscard]] std::span<const Field> given() const { return {fields, field_count}; }
  [[nodiscard]] const Field* find(std::string_view field) const {
    for (const Field& f : given()) {
      if (same_name(f.spec->name, field)) return &f;
    }
    return nullptr;
  }
};

// A Route leads from the field `from` of a node to `to` of another; an exposedField stands for its _changed or its set_
// event.
struct Route {
  std::uint32_t from_node = NodeRef::kNull, to_node = NodeRef::kNull;
  const FieldSpec* from = nullptr;
  const FieldSpec* to = nullptr;
  Position at = 0;
};

// An InnerName is a name that a node has inside of a PROTO only: outside the node goes by another name, or by none.
struct InnerName {
  std::uint32_t scope = 0;
  std::string_view name;
  std::uint32_t node = NodeRef::kNull;
};

// A Document holds all nodes of a world as its texts have them, with PROTOs replaced by the nodes that they stand for
// and Inlines filled: a graph shared by USE. It does not need the texts any more.
struct Document {
  // A node stands behind all nodes that it refers to, so that there is no cycle; but the own fields of a Script, which
  // do not contain nodes, may refer to nodes around it and to itself.
  std::vector<Node> nodes;
  std::vector<NodeRef> top_level;  // null where a node could not be read
  std::vector<Route> routes;       // in file order
  std::vector<InnerName> inner_names;
  std::vector<std::string_view> unreadable_names;   // names of nodes of the world that errors made unreadable
  Arena arena;                                      // all values and names
  std::vector<std::shared_ptr<const void>> arrays;  // large values that were made elsewhere than in `arena`
  std::deque<NodeType> own_types;                   // types of Scripts, and of EXTERNPROTOs that were not found
  LastingIds<NodeId> ids;                           // of the nodes

  // The following members are those of an edited document (core/edit/document_editor.hpp).
  std::vector<std::shared_ptr<const Document>> sources;  // the texts that its nodes came with
  // The values that edits have set, which are in `arena`, by node and field; sorted.
  std::vector<std::pair<std::uint32_t, const FieldSpec*>> set_values;
};

}  // namespace peerd::vrml
