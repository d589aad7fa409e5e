#include "core/parser/node_parser.hpp"

#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd::vrml::node_parser_test {

struct Case {
  const char* name;
  const char* body;
  std::vector<std::string> problems;
};
class Nodes : public testing::TestWithParam<Case> {};
TEST_P(Nodes, AreReported) { EXPECT_EQ(problems_of(GetParam().body), GetParam().problems); }

INSTANTIATE_TEST_SUITE_P(
    Table, Nodes,
    testing::Values(
        Case{"Good", "DEF A Group { } USE A", {}},
        Case{"UnknownType", "Goup { }", {"2:1: unknown node type 'Goup', did you mean 'Group'?"}},
        Case{"NoNode", "Group { children Goup }", {"2:18: expected a node, found 'Goup', did you mean 'Group'?"}},
        Case{"NoName", "DEF 1 Group { }", {"2:5: expected a name after DEF, found '1'"}},
        Case{"NoBrace", "Group 3", {"2:7: expected '{' after Group, found '3'"}},
        Case{"UseOfNothing",
             "DEF Wheel Group { }\nUSE Weel",
             {"3:5: USE of 'Weel', which no DEF before it names, did you mean 'Wheel'?"}},
        Case{"UseOfItself",
             "DEF A Group { children USE A }",
             {"2:28: USE of 'A' inside that node itself: a node cannot contain itself"}},
        // A name of a node that could not be read is known, so its USE is no second mistake.
        Case{"UseOfALostNode", "DEF A Goup { }\nUSE A", {"2:7: unknown node type 'Goup', did you mean 'Group'?"}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(Nodes, AreSharedByUse) {
  const Scene scene = scene_of("DEF A Shape { geometry DEF S Sphere { } } USE A Shape { geometry USE S }");
  EXPECT_EQ(scene.instances.size(), 3u);
  EXPECT_EQ(scene.geometries.size(), 1u);
  EXPECT_EQ(nodes_of_type(*scene.document, "Shape").size(), 2u);
  EXPECT_EQ(document_violation(*scene.document), "");
}

TEST(Nodes, OfAPrototypeTakeTheNameOfTheInstance) {
  const Scene scene = scene_of("PROTO P [ ] { DEF IN Group { } } DEF OUT P { }");
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].def, "OUT");
  ASSERT_EQ(scene.document->inner_names.size(), 1u);
  EXPECT_EQ(scene.document->inner_names[0].name, "IN");
}

}  // namespace peerd::vrml::node_parser_test
