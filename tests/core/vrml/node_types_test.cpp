#include "core/vrml/node_types.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "core/vrml/parser.hpp"

namespace peerd::vrml {
namespace {

TEST(NodeTypes, AreInAlphabeticalOrderWithoutRepeats) {
  std::set<std::string_view> names;
  std::string_view before;
  for (const NodeType& type : node_types()) {
    EXPECT_LT(before, type.name);
    before = type.name;
    EXPECT_TRUE(names.insert(type.name).second);
    EXPECT_EQ(find_node_type(type.name), &type);
  }
  for (const std::string_view name : nodes_not_read_yet()) EXPECT_TRUE(names.insert(name).second) << name;
  // The 54 of VRML97, KeySensor, CollisionInterest and CollisionResponse.
  EXPECT_EQ(names.size(), 57u);
}

TEST(NodeTypes, HaveDefaultsOfTheirFieldsTypes) {
  for (const NodeType& type : node_types()) {
    std::set<std::string_view> names;
    for (const FieldSpec& field : type.fields) {
      const std::string name = std::string(type.name) + "." + std::string(field.name);
      EXPECT_TRUE(names.insert(field.name).second) << name;
      const bool event = field.access == Access::kEventIn || field.access == Access::kEventOut;
      EXPECT_EQ(default_value(field).has_value(), !event) << name;
      const bool node = field.type == FieldType::kSFNode || field.type == FieldType::kMFNode;
      EXPECT_EQ(field.accepts != 0, node && !event) << name;
    }
  }
}

TEST(NodeTypes, NameTheirFieldTypes) {
  EXPECT_EQ(name_of(FieldType::kSFBool), "SFBool");
  EXPECT_EQ(name_of(FieldType::kSFVec3f), "SFVec3f");
  EXPECT_EQ(name_of(FieldType::kMFColor), "MFColor");
  EXPECT_EQ(name_of(FieldType::kMFVec3f), "MFVec3f");
  EXPECT_FALSE(is_list(FieldType::kSFVec3f));
  EXPECT_TRUE(is_list(FieldType::kMFColor));
}

}  // namespace
}  // namespace peerd::vrml
