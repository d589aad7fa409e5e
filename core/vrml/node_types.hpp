#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace peerd::vrml {

// The field types of VRML97 (clause 5). SF is one value; MF is a list.
enum class FieldType : std::uint8_t {
  kSFBool,
  kSFColor,
  kSFFloat,
  kSFImage,
  kSFInt32,
  kSFNode,
  kSFRotation,
  kSFString,
  kSFTime,
  kSFVec2f,
  kSFVec3f,
  kMFColor,
  kMFFloat,
  kMFInt32,
  kMFNode,
  kMFRotation,
  kMFString,
  kMFTime,
  kMFVec2f,
  kMFVec3f,
  kMFColorRGBA,  // X3D's, in nodes that no document keeps
};

enum class Access : std::uint8_t {
  kField,
  kExposedField,
  kEventIn,
  kEventOut,
  kContent,  // no field of the standard, and a file cannot give it: the nodes that the reader found behind a URL
};

// The values that the standard allows in a field of numbers, for each component by itself. A value outside of the range
// is an error if no world can be built from the field. Otherwise it is a warning: a Box of size 0 is a square, and a
// light too bright takes part in no collision.
enum class Range : std::uint8_t { kAny, kNonNegative, kPositive, kSize, kShouldBeNonNegative, kShouldBePositive };

// The places at which a node may stand. A node field accepts a set of these.
enum NodeClass : std::uint16_t {
  kChild = 1,  // among the children of a grouping node, or at the top level
  kAppearance = 2,
  kMaterial = 4,
  kTexture = 8,
  kTextureTransform = 16,
  kGeometry = 32,
  kCoordinate = 64,
  kColor = 128,
  kNormal = 256,
  kTextureCoordinate = 512,
  kFontStyle = 1024,
  kCollisionResponse = 2048,
  kSoundSource = 4096,
  kAnyClass = 0xFFFF,
};

// The role that a node has for the scene builder.
enum class NodeRole : std::uint8_t {
  kPart,     // read through the node that holds it, or what moves others
  kDisplay,  // to be seen or heard only; fields that browsers have added pass with a warning
  kGroup,    // a grouping node that only groups
  kTransform,
  kBillboard,
  kCollision,
  kInline,
  kLod,
  kSwitch,
  kShape,
  kGeometry,
  kCollisionInterest,
  kKeySensor,
  kScript,
};

struct FieldSpec {
  std::string_view name;
  FieldType type;
  Access access;
  std::string_view default_value;  // as VRML text; events and the fields of prototypes and scripts have none
  Range range = Range::kAny;
  std::uint16_t accepts = 0;  // NodeClass set of a node field
};

struct NodeType {
  std::string_view name;
  std::uint16_t classes;  // NodeClass set; of a prototype, its first node's
  NodeRole role;
  std::span<const FieldSpec> fields;
};

// Returns a == b, decided by the first byte where that is possible: most names that are compared differ there.
[[nodiscard]] inline bool same_name(std::string_view a, std::string_view b) {
  return a.size() == b.size() && (a.empty() || (a.front() == b.front() && a == b));
}

[[nodiscard]] std::span<const NodeType> node_types();
[[nodiscard]] const NodeType* find_node_type(std::string_view name);
[[nodiscard]] const FieldSpec* find_field(const NodeType& type, std::string_view name);

[[nodiscard]] std::string_view name_of(FieldType type);
[[nodiscard]] std::optional<FieldType> find_field_type(std::string_view name);
[[nodiscard]] std::string_view name_of(Access access);
[[nodiscard]] std::optional<Access> find_access(std::string_view name);
[[nodiscard]] const FieldSpec& inline_content();                        // field of an Inline: the nodes of its file
[[nodiscard]] std::string_view name_of_classes(std::uint16_t classes);  // for a message: "a geometry node"
// Both return whether an event can be sent from, or to, a field of that access (4.7).
[[nodiscard]] bool sends_events(Access access);
[[nodiscard]] bool takes_events(Access access);
[[nodiscard]] bool has_value(Access access);
// Returns the number of floats in one value; 0 where values are not made of floats.
[[nodiscard]] int float_count(FieldType type);
// Returns the value, as VRML text, of a field that a Script or a PROTO declares without one (ISO/IEC 19775-1, 5.3).
[[nodiscard]] std::string_view default_text_of(FieldType type);
[[nodiscard]] bool is_list(FieldType type);
[[nodiscard]] bool holds_nodes(FieldType type);  // SFNode or MFNode

}  // namespace peerd::vrml
