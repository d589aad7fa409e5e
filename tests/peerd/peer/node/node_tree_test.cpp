#include "peerd/peer/node/node_tree.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/vrml/document.hpp"
#include "tests/peerd/view/picture/picture_of_text.hpp"

namespace peerd::node_tree_test {

using testing::ElementsAre;
using testing_support::scene_of;

// Every row as "path TYPE DEF".
std::vector<std::string> rows_of(const Scene& scene, const NodeTree& tree) {
  std::vector<std::string> path, out;
  for (const NodeRow& row : tree.rows) {
    path.resize(row.depth);
    path.push_back(row.name);
    std::string text;
    for (const std::string& name : path) text += (text.empty() ? "" : "/") + name;
    const vrml::Node& node = scene.document->nodes[row.node];
    EXPECT_EQ(node_at(scene, text), row.node) << text;
    text += " " + std::string(node.type->name);
    if (!node.def.empty()) text += " " + std::string(node.def);
    out.push_back(text);
  }
  return out;
}

const std::string kWorld = R"(
DEF T TimeSensor { loop TRUE }
DEF CAR Transform { children [
  Shape { appearance DEF RED Appearance { material Material { } } geometry Sphere { } }
  DirectionalLight { }
  DEF WHEEL Transform { children Shape { appearance USE RED } } ] }
Collision { children Group { } proxy DEF PLAIN Shape { } }
)";

TEST(NodeTree, HasAllNodesWhereTheyStand) {
  const Scene scene = scene_of(kWorld);
  EXPECT_THAT(
      rows_of(scene, node_tree(scene)),
      ElementsAre("0 TimeSensor T", "CAR Transform CAR", "CAR/0 Shape", "CAR/0/appearance Appearance RED",
                  "CAR/0/appearance/material Material", "CAR/0/geometry Sphere", "CAR/1 DirectionalLight",
                  "CAR/WHEEL Transform WHEEL", "CAR/WHEEL/0 Shape", "CAR/WHEEL/0/appearance Appearance RED",
                  "CAR/WHEEL/0/appearance/material Material", "2 Collision", "2/0 Group", "2/PLAIN Shape PLAIN"));
}

TEST(NodeTree, SaysHowManyRowsItLeavesOut) {
  const Scene scene = scene_of(kWorld);
  const NodeTree tree = node_tree(scene, 5);
  EXPECT_EQ(tree.rows.size(), 5u);
  EXPECT_EQ(tree.left_out, 9u);
}

// A Script may refer to the node that it stands in.
TEST(NodeTree, DoesNotFollowAScript) {
  const Scene scene = scene_of("DEF A Group { children DEF S Script { field SFNode around USE A } }");
  EXPECT_THAT(rows_of(scene, node_tree(scene)), ElementsAre("A Group A", "A/0 Script S"));
  EXPECT_EQ(node_at(scene, "A/0/around"), std::nullopt);
}

TEST(NodeTree, FindsANodeByItsNameToo) {
  const Scene scene = scene_of(kWorld);
  EXPECT_EQ(node_at(scene, "RED"), node_at(scene, "CAR/0/appearance"));
  EXPECT_EQ(node_at(scene, "RED/material"), node_at(scene, "CAR/0/appearance/material"));
  EXPECT_EQ(node_at(scene, "T"), node_at(scene, "0"));
  for (const char* wrong : {"", "9", "CAR/9", "CAR/0/texture", "CAR/0/appearance.0", "CAR/0/appearance/",
                            "CAR/children", "CAR/0/geometry/radius", "NOBODY/0", "/"}) {
    EXPECT_EQ(node_at(scene, wrong), std::nullopt) << wrong;
  }
}

}  // namespace peerd::node_tree_test
