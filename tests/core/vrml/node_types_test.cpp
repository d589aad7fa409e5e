#include "core/vrml/node_types.hpp"
#include "core/vrml/default_values.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "core/parser/parser.hpp"
#include "tests/core/read_text.hpp"

namespace peerd::vrml::node_types_test {

TEST(NodeTypes, AreInAlphabeticalOrderWithoutRepeats) {
  std::string_view before;
  for (const NodeType& type : node_types()) {
    EXPECT_LT(before, type.name);
    before = type.name;
    EXPECT_EQ(find_node_type(type.name), &type);
  }
  // The types are the 54 of VRML97, KeySensor, CollisionInterest and CollisionResponse.
  EXPECT_EQ(node_types().size(), 57u);
}

// The table has the number of exposedFields, fields, eventIns and eventOuts that clause 6 gives each node; appendix C
// of the thesis adds to Shape and Transform, and ours to WorldInfo.
TEST(NodeTypes, HaveTheFieldsOfTheStandard) {
  struct Counts {
    const char* name;
    int exposed_fields, fields, event_ins, event_outs;
  };
  constexpr Counts kStandard[] = {{"Anchor", 4, 2, 2, 0},
                                  {"Appearance", 3, 0, 0, 0},
                                  {"AudioClip", 6, 0, 0, 2},
                                  {"Background", 10, 0, 1, 1},
                                  {"Billboard", 2, 2, 2, 0},
                                  {"Box", 0, 1, 0, 0},
                                  {"Collision", 2, 3, 2, 1},
                                  {"Color", 1, 0, 0, 0},
                                  {"ColorInterpolator", 2, 0, 1, 1},
                                  {"Cone", 0, 4, 0, 0},
                                  {"Coordinate", 1, 0, 0, 0},
                                  {"CoordinateInterpolator", 2, 0, 1, 1},
                                  {"Cylinder", 0, 5, 0, 0},
                                  {"CylinderSensor", 6, 0, 0, 3},
                                  {"DirectionalLight", 5, 0, 0, 0},
                                  {"ElevationGrid", 3, 10, 1, 0},
                                  {"Extrusion", 0, 10, 4, 0},
                                  {"Fog", 3, 0, 1, 1},
                                  {"FontStyle", 0, 9, 0, 0},
                                  {"Group", 1, 2, 2, 0},
                                  {"ImageTexture", 1, 2, 0, 0},
                                  {"IndexedFaceSet", 4, 10, 4, 0},
                                  {"IndexedLineSet", 2, 3, 2, 0},
                                  {"Inline", 1, 2, 0, 0},
                                  {"LOD", 1, 2, 0, 0},
                                  {"Material", 6, 0, 0, 0},
                                  {"MovieTexture", 5, 2, 0, 2},
                                  {"NavigationInfo", 5, 0, 1, 1},
                                  {"Normal", 1, 0, 0, 0},
                                  {"NormalInterpolator", 2, 0, 1, 1},
                                  {"OrientationInterpolator", 2, 0, 1, 1},
                                  {"PixelTexture", 1, 2, 0, 0},
                                  {"PlaneSensor", 5, 0, 0, 3},
                                  {"PointLight", 7, 0, 0, 0},
                                  {"PointSet", 2, 0, 0, 0},
                                  {"PositionInterpolator", 2, 0, 1, 1},
                                  {"ProximitySensor", 3, 0, 0, 5},
                                  {"ScalarInterpolator", 2, 0, 1, 1},
                                  {"Script", 1, 2, 0, 0},
                                  {"Shape", 2, 3, 0, 0},
                                  {"Sound", 9, 1, 0, 0},
                                  {"Sphere", 0, 1, 0, 0},
                                  {"SphereSensor", 3, 0, 0, 3},
                                  {"SpotLight", 10, 0, 0, 0},
                                  {"Switch", 2, 0, 0, 0},
                                  {"Text", 4, 0, 0, 0},
                                  {"TextureCoordinate", 1, 0, 0, 0},
                                  {"TextureTransform", 4, 0, 0, 0},
                                  {"TimeSensor", 5, 0, 0, 4},
                                  {"TouchSensor", 1, 0, 0, 6},
                                  {"Transform", 6 + 5, 2 + 1, 2, 1},
                                  {"Viewpoint", 4, 1, 1, 2},
                                  {"VisibilitySensor", 3, 0, 0, 3},
                                  {"WorldInfo", 0, 5, 0, 0}};
  static_assert(std::size(kStandard) == 54);
  for (const Counts& counts : kStandard) {
    const NodeType* const type = find_node_type(counts.name);
    ASSERT_NE(type, nullptr) << counts.name;
    const auto count = [&](Access access) {
      return static_cast<int>(std::ranges::count(type->fields, access, &FieldSpec::access));
    };
    EXPECT_EQ(count(Access::kExposedField), counts.exposed_fields) << counts.name;
    EXPECT_EQ(count(Access::kField), counts.fields) << counts.name;
    EXPECT_EQ(count(Access::kEventIn), counts.event_ins) << counts.name;
    EXPECT_EQ(count(Access::kEventOut), counts.event_outs) << counts.name;
  }
}

bool holds_nodes(const FieldSpec& field) {
  return field.type == FieldType::kSFNode || field.type == FieldType::kMFNode;
}

TEST(NodeTypes, HaveDefaultsOfTheirFieldsTypes) {
  for (const NodeType& type : node_types()) {
    std::set<std::string_view> names;
    for (const FieldSpec& field : type.fields) {
      const std::string name = std::string(type.name) + "." + std::string(field.name);
      EXPECT_TRUE(names.insert(field.name).second) << name;
      const bool event = field.access == Access::kEventIn || field.access == Access::kEventOut;
      EXPECT_EQ(field.accepts != 0, holds_nodes(field) && !event) << name;
      if (event) continue;
      const Field& value = default_of(field);
      EXPECT_EQ(value.spec, &field) << name;
      const bool one = !is_list(field.type) && !holds_nodes(field) && field.type != FieldType::kSFImage;
      if (one) {
        EXPECT_EQ(value.count, static_cast<std::uint32_t>(std::max(1, float_count(field.type)))) << name;
      }
      if (holds_nodes(field)) {
        EXPECT_EQ(value.count, 0u) << name;
      }
    }
  }
}

// Returns a node that may be the value of a field.
std::string node_for(const FieldSpec& field) {
  for (const NodeType& type : node_types()) {
    if ((type.classes & field.accepts) != 0 && type.name != "Script") return std::string(type.name) + " { }";
  }
  return "";
}

// Returns a value that is not the default, and keeps within every limit of the field.
std::string other_value(const FieldSpec& field) {
  using enum FieldType;
  switch (field.type) {
    case kSFBool:
      return field.default_value == "TRUE" ? "FALSE" : "TRUE";
    case kSFColor:
      return "0.25 0.5 0.75";
    case kSFFloat:
      return "0.125";
    case kSFImage:
      return "1 2 3 0xFF00FF 7";
    case kSFInt32:
      return "1";
    case kSFNode:
      return node_for(field);
    case kSFRotation:
      return "1 0 0 0.5";
    case kSFString:
      return "\"another \\\"value\\\"\"";
    case kSFTime:
      return "1234567890.125";
    case kSFVec2f:
      return "3.5 4.5";
    case kSFVec3f:
      return "3.5 4.5 5.5";
    case kMFColor:
      return "[ 0.25 0.5 0.75, 1 1 0 ]";
    case kMFFloat:
      return "[ 0.125 2.5 ]";
    case kMFInt32:
      return "[ 3 -1 5 ]";
    case kMFNode:
      return "[ " + node_for(field) + " " + node_for(field) + " ]";
    case kMFRotation:
      return "[ 1 0 0 0.5, 0 1 0 2 ]";
    case kMFString:
      return "[ \"one\", \"two\" ]";
    case kMFColorRGBA:
      return "[ 0.25 0.5 0.75 1, 1 1 0 0.5 ]";
    case kMFTime:
      return "[ 1.5 2.5 ]";
    case kMFVec2f:
      return "[ 0.5 0.5, 2 3 ]";
    case kMFVec3f:
      return "[ 1 2 3, 4 5 6 ]";
  }
  return "";
}

// Returns the elements as text, so that equality is that of values.
std::string spelled(const Field& field) {
  using enum FieldType;
  std::string out;
  const auto add = [&](const auto& elements) {
    for (const auto& element : elements) out += std::to_string(element) + ' ';
  };
  if (float_count(field.spec->type) > 0) {
    add(field.as<float>());
  } else if (field.spec->type == kSFBool) {
    out = field.as<bool>()[0] ? "TRUE" : "FALSE";
  } else if (field.spec->type == kSFTime || field.spec->type == kMFTime) {
    add(field.as<double>());
  } else if (field.spec->type == kSFString || field.spec->type == kMFString) {
    for (const std::string_view s : field.as<std::string_view>()) out += '"' + std::string(s) + '"';
  } else if (holds_nodes(*field.spec)) {
    out = std::to_string(field.count) + " nodes";
  } else {
    add(field.as<std::int32_t>());
  }
  return out;
}

struct Read {
  std::shared_ptr<Document> document;
  std::vector<Diagnostic> diagnostics;
};
Read read_node(const std::string& body) {
  const std::string text = world_text(body);
  Problems problems;
  Read read{parse({"node", text, nullptr}, problems), {}};
  read.diagnostics = problems.take().diagnostics;
  std::erase_if(read.diagnostics, [](const Diagnostic& d) {
    return d.message.ends_with("not part of the scene by itself") || d.message.starts_with("this Inline stays empty");
  });
  return read;
}

class EveryNode : public testing::TestWithParam<const NodeType*> {};
TEST_P(EveryNode, ReadsEachFieldsDefaultAndAnotherValue) {
  const NodeType& type = *GetParam();
  for (const FieldSpec& field : type.fields) {
    if (!has_value(field.access)) continue;
    for (const std::string& value : {std::string(field.default_value), other_value(field)}) {
      const std::string body = std::string(type.name) + " { " + std::string(field.name) + " " + value + " }";
      const auto [document, diagnostics] = read_node(body);
      EXPECT_TRUE(diagnostics.empty()) << body << ": " << diagnostics.front().message;
      EXPECT_EQ(document_violation(*document), "") << body;
      const Node& node = document->nodes.at(document->top_level.at(0).index);
      const Field* const given = node.find(field.name);
      ASSERT_NE(given, nullptr) << body;
      EXPECT_EQ(given->spec, &field);
      EXPECT_EQ(spelled(*given) == spelled(default_of(field)), value == field.default_value) << body;
    }
  }
}

TEST_P(EveryNode, ReadsAllFieldsTogetherAndInAProto) {
  const NodeType& type = *GetParam();
  std::string fields, interface, is;
  for (const FieldSpec& field : type.fields) {
    const std::string name(field.name);
    if (has_value(field.access)) fields += name + " " + other_value(field) + "\n";
    if (field.access == Access::kContent) continue;
    interface += std::string(name_of(field.access)) + " " + std::string(name_of(field.type)) + " " + name + " " +
                 (has_value(field.access) ? std::string(field.default_value) : "") + "\n";
    is += name + " IS " + name + "\n";
  }
  const std::string type_name(type.name);
  const auto plain = read_node(type_name + " {\n" + fields + "}");
  EXPECT_TRUE(plain.diagnostics.empty()) << type_name << ": " << plain.diagnostics.front().message;
  const auto proto =
      read_node("PROTO P [\n" + interface + "] { " + type_name + " {\n" + is + "} } P { " + fields + " } P { }");
  EXPECT_TRUE(proto.diagnostics.empty()) << type_name << ": " << proto.diagnostics.front().message;
  EXPECT_EQ(document_violation(*proto.document), "");
  const Node& a = plain.document->nodes.at(plain.document->top_level.at(0).index);
  const Node& b = proto.document->nodes.at(proto.document->top_level.at(0).index);
  const Node& c = proto.document->nodes.at(proto.document->top_level.at(1).index);
  EXPECT_EQ(b.type->name, type.name);
  for (const FieldSpec& field : type.fields) {
    if (!has_value(field.access)) continue;
    EXPECT_EQ(spelled(value_of(a, field.name)), spelled(value_of(b, field.name))) << type_name << '.' << field.name;
    EXPECT_EQ(spelled(value_of(c, field.name)), spelled(default_of(field))) << type_name << '.' << field.name;
  }
}

TEST_P(EveryNode, GivesNoValueToEvents) {
  const NodeType& type = *GetParam();
  for (const FieldSpec& field : type.fields) {
    std::vector<std::string> names;
    if (!has_value(field.access) && field.access != Access::kContent) names = {std::string(field.name)};
    if (field.access == Access::kExposedField)
      names = {"set_" + std::string(field.name), std::string(field.name) + "_changed"};
    for (const std::string& name : names) {
      const std::string body = std::string(type.name) + " { " + name + " " +
                               other_value({"", field.type, Access::kField, "", Range::kAny, kAnyClass}) + " }";
      EXPECT_EQ(read_node(body).diagnostics.size(), 1u) << body;
    }
  }
}

std::vector<const NodeType*> all_types() {
  std::vector<const NodeType*> types;
  for (const NodeType& type : node_types()) types.push_back(&type);
  return types;
}
INSTANTIATE_TEST_SUITE_P(Table, EveryNode, testing::ValuesIn(all_types()),
                         [](const auto& type) { return std::string(type.param->name); });

TEST(NodeTypes, NameTheirFieldTypes) {
  EXPECT_EQ(name_of(FieldType::kSFBool), "SFBool");
  EXPECT_EQ(name_of(FieldType::kSFVec3f), "SFVec3f");
  EXPECT_EQ(name_of(FieldType::kMFColor), "MFColor");
  EXPECT_EQ(name_of(FieldType::kMFVec3f), "MFVec3f");
  EXPECT_FALSE(is_list(FieldType::kSFVec3f));
  EXPECT_TRUE(is_list(FieldType::kMFColor));
  for (int type = 0; type <= static_cast<int>(FieldType::kMFVec3f); ++type) {
    EXPECT_EQ(find_field_type(name_of(static_cast<FieldType>(type))), static_cast<FieldType>(type));
  }
  EXPECT_EQ(find_access("content"), std::nullopt) << "no word of the language";
}

}  // namespace peerd::vrml::node_types_test
