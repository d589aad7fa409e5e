#include "core/vrml/prototype.hpp"

#include <gmock/gmock.h>

namespace peerd::vrml::prototype_test {

using testing::ElementsAre;

// A PROTO whose body is "Transform { translation IS t children Group { } }", with the interface "field SFVec3f t 1 2
// 3".
struct Fixture {
  Fixture() {
    specs[0] = {"t", FieldType::kSFVec3f, Access::kField, {}};
    specs[1] = {"go", FieldType::kSFVec3f, Access::kEventIn, {}};
    prototype.type = {"P", kChild, NodeRole::kPart, specs};
    prototype.defaults = {Field{&specs[0], value, 3, 0}, std::nullopt};
    child = {0, 0};
    const NodeType& transform = *find_node_type("Transform");
    fields[0] = {find_field(transform, "children"), &child, 1, 0};
    prototype.body.nodes = {{.type = find_node_type("Group")},
                            {.type = &transform, .fields = fields, .field_count = 1}};
    prototype.body.roots = {{1, 0}};
    prototype.body.references = 1;
    const FieldSpec* translation = find_field(transform, "translation");
    prototype.links = {{&specs[1], 1, translation, 0}, {&specs[0], 1, translation, 0}};
    sort_links(prototype);
    static_cast<void>(problems.open({"t", "1 2 3", nullptr}));
  }
  Fixture(const Fixture&) = delete;

  float value[3] = {1, 2, 3};
  FieldSpec specs[2];
  NodeRef child;
  Field fields[1];
  Prototype prototype;
  Arena arena;
  Problems problems;
};

TEST(SortLinks, TellsValuesFromEvents) {
  Fixture f;
  ASSERT_EQ(f.prototype.value_links.size(), 1u);
  EXPECT_EQ(f.prototype.value_links[0].node, 1u);
  ASSERT_EQ(f.prototype.event_links.size(), 1u);
  EXPECT_EQ(f.prototype.event_links[0].outer, &f.specs[1]);
  EXPECT_EQ(links_of(f.prototype.links, f.specs[0]).size(), 1u);
  EXPECT_EQ(value_links_of(f.prototype, 0).size(), 0u);
  EXPECT_EQ(value_links_of(f.prototype, 1).size(), 1u);
}

TEST(Expand, CopiesTheBodyWithDefaultsAndMovesItsReferences) {
  Fixture f;
  Body out;
  out.nodes.resize(5, {.type = find_node_type("Group")});
  const Expansion copy = expand(f.prototype, {}, out, f.arena, f.problems);
  EXPECT_EQ(copy.base, 5u);
  EXPECT_EQ(copy.root, 6u);
  ASSERT_EQ(out.nodes.size(), 7u);
  const Node& root = out.nodes[6];
  EXPECT_EQ(root.find("children")->as<NodeRef>()[0].index, 5u);
  EXPECT_THAT(root.find("translation")->as<float>(), ElementsAre(1, 2, 3));
}

TEST(Expand, TakesTheValuesOfTheInstance) {
  Fixture f;
  const float other[3] = {7, 8, 9};
  const Field given[] = {{&f.specs[0], other, 3, 0}};
  Body out;
  const Expansion copy = expand(f.prototype, given, out, f.arena, f.problems);
  EXPECT_THAT(out.nodes[copy.root].find("translation")->as<float>(), ElementsAre(7, 8, 9));
  EXPECT_EQ(linked_values(f.prototype, given)[0], &given[0]);
  EXPECT_EQ(linked_values(f.prototype, {})[0], nullptr);
}

TEST(Expand, GivesEachCopyScopesOfItsOwn) {
  Fixture f;
  f.prototype.body.scopes = 2;
  Body out;
  static_cast<void>(expand(f.prototype, {}, out, f.arena, f.problems));
  const std::uint32_t scopes = out.scopes;
  static_cast<void>(expand(f.prototype, {}, out, f.arena, f.problems));
  EXPECT_EQ(out.nodes[2].scope, out.nodes[0].scope + 2);
  EXPECT_EQ(out.scopes, scopes + 2);
}

TEST(CopyNodes, TakesANodeWithAllThatItRefersTo) {
  Fixture f;
  f.prototype.body.nodes.insert(f.prototype.body.nodes.begin() + 1, {.type = find_node_type("Shape")});
  const NodeSet set = reachable_nodes(f.prototype.body, 2);
  EXPECT_THAT(set.nodes, ElementsAre(0u, 2u));  // the Shape is not among them
  EXPECT_EQ(set.references, 1u);
  Body out;
  const std::uint32_t copy = copy_nodes(f.prototype.body, set, out, f.arena);
  EXPECT_EQ(copy, 1u);
  EXPECT_EQ(out.nodes[1].find("children")->as<NodeRef>()[0].index, 0u);
}

TEST(CostOfFields, IsFreeUpToEight) {
  EXPECT_EQ(cost_of_fields(8), 0u);
  EXPECT_EQ(cost_of_fields(10), 6u);
}

}  // namespace peerd::vrml::prototype_test
