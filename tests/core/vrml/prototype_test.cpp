#include "core/vrml/prototype.hpp"

#include <gtest/gtest.h>

namespace peerd::vrml::prototype_test {

// A PROTO of the interface "field SFVec3f t eventIn SFVec3f go", both of which are the translation of its one node.
TEST(SortLinks, TellsValuesFromEvents) {
  const NodeType& transform = *find_node_type("Transform");
  const FieldSpec* const translation = find_field(transform, "translation");
  const FieldSpec specs[] = {{"t", FieldType::kSFVec3f, Access::kField, {}},
                             {"go", FieldType::kSFVec3f, Access::kEventIn, {}}};
  Prototype prototype;
  prototype.type = {"P", kChild, NodeRole::kPart, specs};
  prototype.body.nodes = {{.type = &transform}};
  prototype.links = {{&specs[1], 0, translation, 0}, {&specs[0], 0, translation, 0}};
  sort_links(prototype);
  ASSERT_EQ(prototype.value_links.size(), 1u);
  EXPECT_EQ(prototype.value_links[0].node, 0u);
  ASSERT_EQ(prototype.event_links.size(), 1u);
  EXPECT_EQ(prototype.event_links[0].outer, &specs[1]);
  EXPECT_EQ(links_of(prototype.links, specs[0]).size(), 1u);
  EXPECT_EQ(value_links_of(prototype, 0).size(), 1u);
}

TEST(CostOfFields, IsFreeUpToEight) {
  EXPECT_EQ(cost_of_fields(8), 0u);
  EXPECT_EQ(cost_of_fields(10), 6u);
}

}  // namespace peerd::vrml::prototype_test
