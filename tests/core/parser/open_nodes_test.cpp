#include "core/parser/open_nodes.hpp"

#include <gmock/gmock.h>

#include "tests/core/parser/text_fixture.hpp"

namespace peerd::vrml::open_nodes_test {

TEST(FindFieldOf, FindsFieldsOfTheTypeAndOfTheScript) {
  const TextFixture t("");
  OpenNode script{.type = find_node_type("Script")};
  EXPECT_NE(find_field_of(t.state, script, "mustEvaluate"), nullptr);
  EXPECT_EQ(find_field_of(t.state, script, "speed"), nullptr);
  script.own_fields.push_back({"speed", FieldType::kSFFloat, Access::kField, {}});
  EXPECT_EQ(find_field_of(t.state, script, "speed"), &script.own_fields.front());
}

TEST(FindFieldOf, HidesTheContentOfAnInline) {
  const TextFixture t("");
  const OpenNode node{.type = find_node_type("Inline")};
  EXPECT_NE(find_field_of(t.state, node, "url"), nullptr);
  EXPECT_EQ(find_field_of(t.state, node, inline_content().name), nullptr);
}

TEST(OpenNodes, TellFieldsFromOtherWords) {
  const TextFixture t("");
  OpenNodes nodes;
  EXPECT_TRUE(nodes.is_field(t.state, "eventIn"));  // in an interface
  EXPECT_FALSE(nodes.is_field(t.state, "radius"));
  OpenNode sphere{.type = find_node_type("Sphere")};
  nodes.innermost = &sphere;
  EXPECT_TRUE(nodes.is_field(t.state, "radius"));
  EXPECT_FALSE(nodes.is_field(t.state, "eventIn"));
  OpenNode script{.type = find_node_type("Script")};
  nodes.innermost = &script;
  EXPECT_TRUE(nodes.is_field(t.state, "eventIn"));
}

TEST(OpenNodes, PassOverAValueAndKeepTheUsesOfAScript) {
  TextFixture t("1 2 3 translation");
  OpenNodes nodes;
  Definition definition;
  nodes.script_uses.push_back(&definition);
  nodes.skip_value(t.state);
  EXPECT_TRUE(t.state.tokens.at_word("translation"));
  EXPECT_THAT(nodes.script_uses, testing::ElementsAre(&definition));
}

}  // namespace peerd::vrml::open_nodes_test
