#include "core/motion/inert_parts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace peerd::inert_parts_test {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::StartsWith;

// The warnings of a world, each as "LINE:COLUMN MESSAGE"; `world` begins in line 1.
std::vector<std::string> warnings(const std::string& world) {
  const std::string text = "#VRML V2.0 utf8\n" + world;
  ReadResult read = read_world(text);
  if (!read.scene) throw std::runtime_error(render(read, read.diagnostics.front()));
  warn_of_inert_parts(read);
  std::vector<std::string> lines;
  for (const Diagnostic& d : read.diagnostics) {
    EXPECT_EQ(d.severity, Severity::kWarning);
    EXPECT_EQ(read.sources.at(d.source).text, text) << "the texts are still there";
    lines.push_back(std::to_string(d.where.line - 1) + ":" + std::to_string(d.where.column) + " " + d.message);
  }
  return lines;
}

constexpr const char* kBall = "children Shape { geometry Sphere { } }";
const std::string kPath = R"(
DEF CLOCK TimeSensor { loop TRUE }
DEF PATH PositionInterpolator { key [ 0 1 ] keyValue [ 1 1 1, 2 2 2 ] }
ROUTE CLOCK.fraction_changed TO PATH.set_fraction
)";

TEST(InertParts, AWorldThatActsHasNone) {
  EXPECT_THAT(warnings(kPath + R"(
DEF A Transform { velocityVector 1 0 0 distanceThreshold 0.1 enslaved TRUE remote TRUE
  collisionResponse CollisionResponse { } children Shape { geometry Box { } splitThreshold 10 convexHull [ ] } }
DEF B Transform { children Shape { geometry DEF FACES IndexedFaceSet {
  coord DEF POINTS Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] } coordIndex [ 0 1 2 ] } } }
DEF BEND CoordinateInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 0 0, 0 1 0, 0 0 0, 1 0 0, 0 2 0 ] }
ROUTE CLOCK.fraction_changed TO BEND.set_fraction
ROUTE BEND.value_changed TO POINTS.point
ROUTE PATH.value_changed TO B.translation
ROUTE CLOCK.isActive TO CLOCK.enabled
CollisionInterest { objectPath "A" interests "B" })"),
              IsEmpty());
  EXPECT_THAT(warnings(""), IsEmpty());
}

TEST(InertParts, FieldsOfAnEngineThatIsNotInUseAreCounted) {
  EXPECT_THAT(
      warnings("Shape { splitThreshold 9 }\nShape { convexHull [ 0 0 0 ] }\nShape { splitThreshold 11 }\n"
               "Shape { hierarchyFile \"a\" } Shape { hierarchyFile \"\" }"),
      ElementsAre("1:24 splitThreshold does nothing: it is of the plain k-DOP tree, and another engine is in use "
                  "(and 1 more like it)",
                  StartsWith("2:20 convexHull does nothing: "),
                  "4:23 hierarchyFile is for peerd bake and peerd collide: a peer builds its hierarchies itself"));
}

TEST(InertParts, HierarchyFilesActWhereNoPeerReads) {
  const std::string text = "#VRML V2.0 utf8\nShape { hierarchyFile \"a\" }";
  ReadResult read = read_world(text);
  warn_of_inert_parts(read, true);
  EXPECT_THAT(read.diagnostics, IsEmpty());
}

TEST(InertParts, EachRouteFromNotCollidingIsNamed) {
  EXPECT_THAT(warnings("DEF A Transform { } DEF CLOCK TimeSensor { }\nROUTE A.notColliding TO CLOCK.enabled\n"
                       "ROUTE A.notColliding TO CLOCK.loop"),
              ElementsAre(StartsWith("2:9 no peer runs this ROUTE from notColliding: "),
                          StartsWith("3:9 no peer runs this ROUTE from notColliding: ")));
}

TEST(InertParts, RoutesThatNothingStartsAreCountedByTheirNodes) {
  EXPECT_THAT(
      warnings(kPath + "DEF TOUCH TouchSensor { }\nDEF LIGHT DirectionalLight { }\n"
                       "ROUTE TOUCH.isOver TO LIGHT.on\nROUTE TOUCH.isOver TO CLOCK.enabled\n"
                       "DEF A Transform { } DEF B Transform { }\nROUTE A.translation TO B.translation"),
      ElementsAre("7:13 this ROUTE is never run: no TimeSensor leads to it, and nothing else makes a TouchSensor "
                  "send events in a peer (and 1 more like it)",
                  StartsWith("10:9 this ROUTE is never run: no TimeSensor leads to it")));
}

// A door that a click opens, and a slider: a viewer's page runs such ROUTEs by edits.
TEST(InertParts, RoutesThatPeopleRunOnAPageAreNoFinding) {
  EXPECT_THAT(
      warnings("DEF HANDLE TouchSensor { } DEF SLIDER PlaneSensor { } DEF NEAR ProximitySensor { size 9 9 9 }\n"
               "DEF CLOCK TimeSensor { } DEF SWING PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0 1 0 0 ] }\n"
               "DEF DOOR Transform { } DEF KNOB Transform { }\n"
               "ROUTE HANDLE.touchTime TO CLOCK.set_startTime\nROUTE NEAR.enterTime TO CLOCK.set_startTime\n"
               "ROUTE CLOCK.fraction_changed TO SWING.set_fraction\n"
               "ROUTE SWING.value_changed TO DOOR.set_translation\n"
               "ROUTE SLIDER.translation_changed TO KNOB.set_translation"),
      IsEmpty());
}

TEST(InertParts, RoutesIntoWhatNobodyEvaluatesAreNamed) {
  EXPECT_THAT(
      warnings(
          kPath +
          R"(DEF A Transform { } DEF S Switch { } Shape { appearance Appearance { material DEF COLOR Material { } } } DEF V Viewpoint { }
DEF STEP ScalarInterpolator { key [ 0 1 ] keyValue [ 0 1 ] }
ROUTE CLOCK.fraction_changed TO STEP.set_fraction
ROUTE PATH.value_changed TO A.velocityVector
ROUTE PATH.value_changed TO V.position
ROUTE STEP.value_changed TO A.distanceThreshold
ROUTE STEP.value_changed TO COLOR.shininess)"),
      ElementsAre("8:12 no peer runs this ROUTE: Transform.velocityVector stays as the file has it",
                  "9:12 no peer runs this ROUTE: what it changes is only seen or heard (and 1 more like it)",
                  "10:12 no peer runs this ROUTE: Transform.distanceThreshold stays as the file has it"));
}

// A node that passes an event on is no end, whatever it is.
TEST(InertParts, ARelayPassesEventsOn) {
  EXPECT_THAT(warnings(kPath + "DEF V Viewpoint { } DEF A Transform { }\nROUTE PATH.value_changed TO V.position\n"
                               "ROUTE V.position TO A.translation"),
              IsEmpty());
}

TEST(InertParts, ResponsesThatAnswerNothingAreNamed) {
  const auto with = [](const std::string& response, const std::string& interests) {
    return warnings("DEF A Transform { collisionResponse CollisionResponse { " + response + " } " + kBall +
                    " }\nDEF B Transform { " + kBall + " } " + interests);
  };
  EXPECT_THAT(with("", ""), ElementsAre("1:37 collisionResponse does nothing: no CollisionInterest names this node"));
  EXPECT_THAT(with("", "CollisionInterest { objectPath \"B\" interests \"A\" }"),
              ElementsAre("1:37 collisionResponse does nothing: this node is the objectPath of no CollisionInterest"));
  EXPECT_THAT(with("", "CollisionInterest { objectPath \"A\" interests \"B\" }"), IsEmpty());
  EXPECT_THAT(with("responseType 2 restitution 0.5", "CollisionInterest { objectPath \"B\" interests \"A\" }"),
              IsEmpty())
      << "the restitution of a cushion counts";
  EXPECT_THAT(with("responseType 2 friction 0.5", ""), IsEmpty()) << "it slides to rest";
}

TEST(InertParts, WhatARouteMovesHasNoOwnerByTheFileAndNoOtherVelocity) {
  EXPECT_THAT(warnings(kPath + "DEF A Transform { enslaved TRUE velocityVector 1 0 0 }\n"
                               "ROUTE PATH.value_changed TO A.translation"),
              ElementsAre("5:28 enslaved gives this node no owner: a ROUTE moves it, the same on all peers",
                          StartsWith("5:48 velocityVector counts only while a peer owns this node")));
}

TEST(InertParts, WhatChangesItsShapeHasNoOwner) {
  const auto said = warnings(kPath + R"(DEF A Transform { enslaved TRUE remote TRUE distanceThreshold 1
  collisionResponse CollisionResponse { } }
KeySensor { recipient "A" keyValue 32 }
ROUTE PATH.value_changed TO A.scale)");
  EXPECT_THAT(said, testing::Contains(StartsWith("5:28 enslaved does nothing: no owner moves what a driven scale")));
  EXPECT_THAT(said, testing::Contains(StartsWith("5:40 remote does nothing: ")));
  EXPECT_THAT(said, testing::Contains(StartsWith("5:63 distanceThreshold does nothing: ")));
  EXPECT_THAT(said, testing::Contains(StartsWith("6:21 collisionResponse does nothing: no owner moves")));
  EXPECT_THAT(said, testing::Contains(StartsWith("7:23 this KeySensor moves nothing: ")));
}

TEST(InertParts, ABillboardThatAnInterestConcernsIsNamed) {
  const std::string world = std::string("DEF A Transform { children DEF BOARD Billboard { ") + kBall +
                            " } } DEF B Transform { " + kBall + " }\nBillboard { " + kBall + " }\n";
  EXPECT_THAT(warnings(world), IsEmpty());
  EXPECT_THAT(warnings(world + "CollisionInterest { objectPath \"A\" interests \"B\" }"),
              ElementsAre("1:28 this Billboard collides as the file has it: it is not turned"));
  EXPECT_THAT(warnings(world + "CollisionInterest { objectPath \"B\" interests \"A/BOARD/0\" }"), testing::SizeIs(1));
}

TEST(InertParts, EndsWithoutPolygonsAreNamedOnce) {
  EXPECT_THAT(warnings(std::string("DEF A Group { } DEF B Transform { ") + kBall +
                       " } DEF C Transform { children Shape { geometry Text { } } }\n"
                       "DEF D Collision { collide FALSE " +
                       kBall +
                       " }\n"
                       "CollisionInterest { objectPath \"A\" interests [ \"B\" \"C\" ] }\n"
                       "CollisionInterest { objectPath \"B\" collisionInterests [ \"A\" \"D\" ] }"),
              ElementsAre("3:32 interests in 'A' find nothing: no polygons in it collide",
                          "3:46 interests in 'C' find nothing: no polygons in it collide",
                          "4:55 interests in 'D' find nothing: no polygons in it collide"));
}

TEST(InertParts, WhatPatternsFindMayHaveNoPolygonsAsLongAsSomeHave) {
  const std::string world = std::string("DEF A1 Group { } DEF B1 Transform { ") + kBall + " } DEF A2 Group { }\n";
  EXPECT_THAT(warnings(world + "CollisionInterest { objectPath \"*\" interests \"*\" }"), IsEmpty());
  EXPECT_THAT(warnings(world + "CollisionInterest { objectPath \"B1\" interests [ \"B*\" \"A1\" ] }"),
              testing::Contains(testing::HasSubstr("interests in 'A1' find nothing")));
  EXPECT_THAT(warnings(world + "CollisionInterest { objectPath \"B1\" interests \"A*\" }"), testing::SizeIs(2));
}

// Copies of a PROTO stand at one place.
TEST(InertParts, APrototypeIsCountedOnce) {
  EXPECT_THAT(warnings("PROTO P [ ] { Shape { splitThreshold 3 } } P { } P { }\nShape { splitThreshold 3 }"),
              ElementsAre(testing::EndsWith("(and 1 more like it)")));
}

}  // namespace peerd::inert_parts_test
