#pragma once
#include <cstdint>
#include <span>
#include <string_view>

namespace peerd::vrml {

// VRML97 clause 5. SF: one value; MF: a list.
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
};

enum class Access : std::uint8_t { kField, kExposedField, kEventIn, kEventOut };

// What values of a number field the standard allows, each component by itself.
enum class Range : std::uint8_t { kAny, kNonNegative, kPositive };

// Where a node may stand. A node field accepts a set of these.
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
};

// What the scene builder makes of a node.
enum class Meaning : std::uint8_t {
  kPart,  // read through the node that holds it, or of no concern to a scene that collides (lights, viewpoints)
  kGroup,
  kTransform,
  kShape,
  kBox,
  kIndexedFaceSet,
  kOtherGeometry,  // kept, and named as not tessellated
  kCollisionInterest,
};

struct FieldSpec {
  std::string_view name;
  FieldType type;
  Access access;
  std::string_view default_value;  // as VRML text; events have none
  Range range = Range::kAny;
  std::uint16_t accepts = 0;  // NodeClass set of a node field
};

struct NodeType {
  std::string_view name;
  NodeClass node_class;
  Meaning meaning;
  std::span<const FieldSpec> fields;
};

[[nodiscard]] std::span<const NodeType> node_types();
[[nodiscard]] const NodeType* find_node_type(std::string_view name);
[[nodiscard]] const FieldSpec* find_field(const NodeType& type, std::string_view name);
// Nodes of VRML97 and of the seed's appendix C that have no row in the table yet.
[[nodiscard]] std::span<const std::string_view> nodes_not_read_yet();

[[nodiscard]] std::string_view name_of(FieldType type);
[[nodiscard]] std::string_view name_of(NodeClass node_class);  // for a message: "a geometry node"
// Floats in one value; 0 where values are not made of floats.
[[nodiscard]] int float_count(FieldType type);
[[nodiscard]] bool is_list(FieldType type);

}  // namespace peerd::vrml
