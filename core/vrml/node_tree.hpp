#pragma once
#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <unordered_map>
#include <variant>
#include <vector>

#include "core/vrml/diagnostics.hpp"
#include "core/vrml/node_types.hpp"

namespace peerd::vrml {

// Nodes inside nodes, in the text or through USE. Deeper input is refused; the reader recurses this far.
inline constexpr std::uint32_t kMaxNesting = 256;

// A node where it stands: written there, or USEd there.
struct NodeRef {
  static constexpr std::uint32_t kNull = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t index = kNull;  // into NodeTree::nodes
  Spot spot;

  explicit operator bool() const { return index != kNull; }
};

using Floats = std::array<float, 4>;  // SFColor, SFFloat, SFRotation, SFVec2f, SFVec3f; the rest is 0

// The value of a field by its type: bool | SFInt32 | SFTime | floats | SFString | SFNode | MF of floats, flat |
// MFInt32 and SFImage (width, height, components, pixels) | MFTime | MFString | MFNode.
using Value =
    std::variant<bool, std::int32_t, double, Floats, std::string, NodeRef, std::vector<float>,
                 std::vector<std::int32_t>, std::vector<double>, std::vector<std::string>, std::vector<NodeRef>>;

struct FieldValue {
  const FieldSpec* spec = nullptr;
  Spot spot;  // of the value's first token
  Value value;
};

struct Node {
  const NodeType* type = nullptr;
  std::string_view def;
  Spot spot;
  std::vector<FieldValue> fields;  // those that the text gives; the table has the defaults
  bool damaged = false;            // an error inside it is reported: what follows from it needs no second report

  [[nodiscard]] const FieldValue* find(std::string_view field) const {
    for (const FieldValue& f : fields) {
      if (f.spec->name == field) return &f;
    }
    return nullptr;
  }
};

struct Definition {
  std::size_t offset = 0;                // of the name in the text: tells two nodes of one name apart
  std::uint32_t index = NodeRef::kNull;  // kNull while the node is open, and where an error made it unreadable
  bool open = false;
};

// All nodes of a text, shared by USE: a graph without cycles. Strings point into the text.
struct NodeTree {
  std::vector<Node> nodes;         // in order of their closing braces, so a node stands after all that it refers to
  std::vector<NodeRef> top_level;  // null where a node could not be read
  std::unordered_map<std::string_view, Definition> defined;  // by DEF name, the last of each name
};

}  // namespace peerd::vrml
