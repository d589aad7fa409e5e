#include "peerd/view/picks/inspect.hpp"

#include <gtest/gtest.h>

#include "tests/has_members.hpp"
#include "tests/peerd/peer/node/lone_peer.hpp"

namespace peerd::view::inspect_test {

using peerd::testing_support::LonePeer;

TEST(Inspect, SaysWhatANodeIsWithItsFieldsAndData) {
  LonePeer lone(R"(#VRML V2.0 utf8
DEF DRIVEN Transform { distanceThreshold 0.25 children [
  DEF S Shape { geometry IndexedFaceSet { coord Coordinate { point [0 0 0, 1 0 0, 0 1 0] } coordIndex [0 1 2] } } Group { } ] }
DEF OTHER Transform { }
)",
                {"DRIVEN"});
  PeerNode& node = lone.make();
  lone.run(0.5);
  const config::SceneEdit edit{
      .kind = config::SceneEdit::Kind::kData, .path = "DRIVEN", .key = "colour", .data = "red"};
  ASSERT_TRUE(node.edit(lone.now, edit).done());
  lone.run(2.0);
  const auto own = inspect(node, *node.scene().find("DRIVEN"));
  EXPECT_THAT(own, HasMembers(R"(
    {"id": "0", "path": "DRIVEN", "def": "DRIVEN", "type": "Transform", "owner": 1, "own": true,
    "driven": true, "threshold_m": 0.25, "fields": {"distanceThreshold": "0.25",
    "children": "[ DEF S Shape { .. }, Group { .. } ]"}, "data": {"colour": "red"}})"));
  const auto other = inspect(node, *node.scene().find("OTHER"));
  EXPECT_TRUE(other.at("owner").is_null());
  EXPECT_TRUE(other.at("threshold_m").is_null());
  EXPECT_TRUE(other.at("data").empty());
}

TEST(Inspect, SaysWhatStandsAnywhereInTheTree) {
  LonePeer lone(R"(#VRML V2.0 utf8
DEF CLOCK TimeSensor { cycleInterval 4 }
DEF HOUSE Transform { children Shape { appearance Appearance { material Material { diffuseColor 1 0 0 } } } }
DEF DRIVEN Transform { }
)",
                {"DRIVEN"});
  PeerNode& node = lone.make();
  lone.run(0.5);
  EXPECT_EQ(inspect(node, std::string("HOUSE")), inspect(node, *node.scene().find("HOUSE")));
  EXPECT_THAT(inspect(node, std::string("CLOCK")), HasMembers(R"(
    {"id": null, "path": "CLOCK", "type": "TimeSensor", "owner": null, "fields": {"cycleInterval": "4"}})"));
  const std::string paint = "HOUSE/0/appearance/material";
  EXPECT_THAT(inspect(node, paint), HasMembers(R"(
    {"id": null, "path": "HOUSE/0/appearance/material", "def": "", "type": "Material", "own": false,
    "fields": {"diffuseColor": "1 0 0"}, "data": {}})"));
  const config::SceneEdit edit{
      .kind = config::SceneEdit::Kind::kSet, .path = paint, .field = "diffuseColor", .value = "0 1 0"};
  ASSERT_EQ(node.edit(lone.now, edit).refused, "");
  lone.run(2.0);
  EXPECT_EQ(inspect(node, paint).at("fields").at("diffuseColor"), "0 1 0");
  EXPECT_THAT(inspect(node, std::string("HOUSE/7")),
              HasMembers(R"({"ok": false, "error": "the scene has no HOUSE/7"})"));
}

TEST(Inspect, LongValuesAreCut) {
  std::string hull = "DEF X Shape { convexHull [";
  for (int i = 0; i < 3000; ++i) hull += std::to_string(i) + " 0 0, ";
  LonePeer lone(("#VRML V2.0 utf8\n" + hull + "] geometry Box { } }\nDEF DRIVEN Transform { }\n").c_str(), {"DRIVEN"});
  PeerNode& node = lone.make();
  const std::string text = inspect(node, *node.scene().find("X")).at("fields").at("convexHull");
  EXPECT_LT(text.size(), 2100u);
  EXPECT_TRUE(text.ends_with(" .."));
}

}  // namespace peerd::view::inspect_test
