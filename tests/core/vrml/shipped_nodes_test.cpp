// The declarations that configs/worlds/peerd-nodes.wrl ships, so that other browsers load worlds with our own nodes.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "core/vrml/node_types.hpp"
#include "tests/core/read_text.hpp"

namespace peerd::shipped_nodes_test {

std::string shipped() {
  std::ifstream in(PEERD_SOURCE_DIR "/configs/worlds/peerd-nodes.wrl");
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

TEST(ShippedNodes, ReadWithoutAProblem) {
  const std::string text = shipped();
  const ReadResult result = read_world(text);
  EXPECT_TRUE(result.scene.has_value());
  for (const Diagnostic& d : result.diagnostics) ADD_FAILURE() << render(result, d);
}

// An EXTERNPROTO with the whole interface of each, as a world would declare it.
TEST(ShippedNodes, AreTheBuiltInNodes) {
  const std::string text = shipped();
  for (const auto& [name, type] :
       {std::pair("CollisionInterest", "CollisionInterest"), std::pair("CollisionResponse", "CollisionResponse"),
        std::pair("KeySensor", "KeySensor"), std::pair("PeerTransform", "Transform"), std::pair("PeerShape", "Shape"),
        std::pair("PeerWorldInfo", "WorldInfo")}) {
    EXPECT_NE(text.find(std::string("PROTO ") + name + " ["), std::string::npos);
    const vrml::NodeType* node = vrml::find_node_type(type);
    ASSERT_NE(node, nullptr);
    std::string declaration = std::string("EXTERNPROTO ") + name + " [ ";
    for (const vrml::FieldSpec& field : node->fields) {
      if (field.name == "collisionInterests") continue;  // only a second spelling of interests
      std::string entry(vrml::name_of(field.access));
      entry += ' ' + std::string(vrml::name_of(field.type)) + ' ' + std::string(field.name);
      declaration += entry + ' ';
      EXPECT_NE(text.find(entry), std::string::npos) << name << " is shipped without " << entry;
    }
    const std::string body = declaration + "] [ \"peerd-nodes.wrl#" + name + "\" \"urn:peerd:node:" + type + "\" ]\n";
    EXPECT_EQ(problems_of(body), std::vector<std::string>{}) << body;
  }
}

TEST(ShippedNodes, MeanTheSameAsTheBuiltInOnes) {
  const Scene scene = scene_of(R"(
    EXTERNPROTO PeerTransform [ exposedField MFNode children exposedField SFVec3f velocityVector exposedField SFNode collisionResponse ]
      [ "peerd-nodes.wrl#PeerTransform" "urn:peerd:node:Transform" ]
    EXTERNPROTO CollisionResponse [ field SFInt32 responseType ] "peerd-nodes.wrl#CollisionResponse"
    DEF CAR PeerTransform { velocityVector 1 2 3 collisionResponse CollisionResponse { responseType 1 } })");
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].kind, NodeKind::kTransform);
  EXPECT_EQ(scene.object(ObjectId{0}).velocity, Vec3(1, 2, 3));
  ASSERT_TRUE(scene.object(ObjectId{0}).response.has_value());
  EXPECT_EQ(scene.object(ObjectId{0}).response->type, ResponseType::kZero);
}

}  // namespace peerd::shipped_nodes_test
