// These tests are about ROUTE (ISO/IEC 14772-1:1997, 4.3.9, 4.7 and 4.10.2).
#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd::vrml::route_parser_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kNodes =
    "DEF T TimeSensor { } DEF I PositionInterpolator { } DEF X Transform { } DEF Y Transform { } DEF S TouchSensor { "
    "}\n";

std::vector<std::string> routes(const std::string& body, const Files& files = {}) {
  const Scene scene = scene_of(body, files);
  EXPECT_EQ(document_violation(*scene.document), "");
  return routes_of(*scene.document);
}

TEST(Route, JoinsTwoNodes) {
  EXPECT_THAT(routes(kNodes + "ROUTE T.fraction_changed TO I.set_fraction ROUTE I.value_changed TO X.set_translation"),
              ElementsAre("T.fraction_changed > I.set_fraction", "I.value_changed > X.translation"));
}

TEST(Route, StandsForAnExposedFieldsEventsByAnyOfTheirNames) {
  for (const char* from : {"X.translation", "X.translation_changed"}) {
    for (const char* to : {"Y.translation", "Y.set_translation"}) {
      EXPECT_THAT(routes(kNodes + "ROUTE " + from + " TO " + to), ElementsAre("X.translation > Y.translation"));
    }
  }
}

// 4.10.2: "the set_ or _changed part of the event's name is optional", for every event and not only an exposedField's.
TEST(Route, FindsEventsWithoutSetAndChanged) {
  EXPECT_THAT(routes(kNodes + "ROUTE T.fraction TO I.fraction"), ElementsAre("T.fraction_changed > I.set_fraction"));
  EXPECT_THAT(routes(kNodes + "ROUTE I.value TO X.translation"), ElementsAre("I.value_changed > X.translation"));
  EXPECT_THAT(routes("DEF A Script { eventOut SFBool on_changed eventIn SFBool set_on } ROUTE A.on TO A.on"),
              ElementsAre("A.on_changed > A.set_on"));
  EXPECT_THAT(routes("PROTO P [ eventOut SFTime go_changed eventIn SFTime set_go ] { TimeSensor { startTime IS set_go "
                     "cycleTime IS go_changed } }\n"
                     "DEF A P { } DEF B P { } ROUTE A.go TO B.go"),
              ElementsAre("A.cycleTime > B.startTime"));
}

TEST(Route, LetsSpaceStandAroundItsPeriods) {
  EXPECT_THAT(routes(kNodes + "ROUTE T . isActive TO S\n.\nenabled"), ElementsAre("T.isActive > S.enabled"));
}

// 4.10.2: "Redundant routing is ignored."
TEST(Route, RepeatedCountsOnce) {
  EXPECT_THAT(
      routes(kNodes + "ROUTE S.isActive TO T.enabled ROUTE S.isActive TO T.enabled ROUTE S.isActive TO T.set_enabled"),
      ElementsAre("S.isActive > T.enabled"));
  EXPECT_THAT(
      routes("PROTO P [ eventIn SFBool a eventIn SFBool b ] { TimeSensor { enabled IS a loop IS b } }\n"
             "DEF S TouchSensor { } DEF D P { } ROUTE S.isOver TO D.a ROUTE S.isOver TO D.b ROUTE S.isOver TO D.a"),
      ElementsAre("S.isOver > D.enabled", "S.isOver > D.loop"));
}

// A ROUTE may stand at the top level, in a PROTO, or inside a node wherever fields may appear (4.10.2).
TEST(Route, MayStandInsideANode) {
  EXPECT_THAT(routes("Group { children [ DEF S TouchSensor { } DEF T TimeSensor { } ROUTE S.isOver TO T.enabled ]\n"
                     "ROUTE S.isActive TO T.loop }"),
              ElementsAre("S.isOver > T.enabled", "S.isActive > T.loop"));
  EXPECT_THAT(routes("DEF T TimeSensor { ROUTE T.isActive TO T.loop loop TRUE }"), ElementsAre("T.isActive > T.loop"));
}

TEST(Route, MeansTheLastNodeOfAName) {  // 4.6.2
  const Scene scene = scene_of(
      "DEF A Transform { translation 1 0 0 } DEF A Transform { translation 2 0 0 } DEF B Transform { } ROUTE A.scale "
      "TO B.scale\n"
      "DEF A Transform { }");
  ASSERT_EQ(scene.document->routes.size(), 1u);
  EXPECT_EQ(floats(scene.document->nodes[scene.document->routes[0].from_node], "translation")[0], 2);
}

TEST(Route, KeepsTheFilesOrder) {
  EXPECT_THAT(
      routes(
          kNodes +
          "ROUTE X.scale TO Y.scale ROUTE S.isOver TO T.loop ROUTE T.isActive TO S.enabled ROUTE X.center TO Y.center"),
      ElementsAre("X.scale > Y.scale", "S.isOver > T.loop", "T.isActive > S.enabled", "X.center > Y.center"));
}

TEST(RouteInAProto, IsEachInstancesOwn) {
  const Scene scene = scene_of(R"(
    PROTO Clock [ ] { Group { children [ DEF T TimeSensor { } DEF I PositionInterpolator { } ] }
                      ROUTE T.fraction_changed TO I.set_fraction }
    Clock { } Clock { })");
  ASSERT_EQ(scene.document->routes.size(), 2u);
  EXPECT_EQ(document_violation(*scene.document), "");
  EXPECT_NE(scene.document->routes[0].from_node, scene.document->routes[1].from_node);
  EXPECT_NE(scene.document->routes[0].to_node, scene.document->routes[1].to_node);
}

// 4.8.3: an event goes to all nodes that have IS for it.
TEST(RouteToAnInstance, FansOutThroughIs) {
  EXPECT_THAT(
      routes(R"(
    PROTO Lamp [ eventIn SFBool on eventOut SFBool lit exposedField SFVec3f at 0 0 0 ] {
      Group { children [ DEF A TimeSensor { enabled IS on isActive IS lit } DEF B TouchSensor { enabled IS on isOver IS lit }
                         DEF C Transform { translation IS at } DEF D Transform { center IS at } ] } }
    DEF L Lamp { } DEF S TouchSensor { } DEF T TimeSensor { } DEF X Transform { }
    ROUTE S.isActive TO L.on
    ROUTE L.lit TO T.loop
    ROUTE X.scale TO L.set_at
    ROUTE L.at_changed TO X.center
    ROUTE L.lit TO L.on)"),
      ElementsAre("S.isActive > A.enabled", "S.isActive > B.enabled", "A.isActive > T.loop", "B.isOver > T.loop",
                  "X.scale > C.translation", "X.scale > D.center", "C.translation > X.center", "D.center > X.center",
                  "A.isActive > A.enabled", "A.isActive > B.enabled", "B.isOver > A.enabled", "B.isOver > B.enabled"));
}

TEST(RouteToAnInstance, GoesThroughTwoLevels) {
  EXPECT_THAT(routes(R"(
    PROTO In [ eventIn SFVec3f go eventOut SFVec3f gone exposedField SFVec3f p 0 0 0 ] {
      DEF IN Transform { set_translation IS go translation_changed IS gone scale IS p } }
    PROTO Out [ eventIn SFVec3f start eventOut SFVec3f end exposedField SFVec3f q 1 1 1 ] {
      Group { children [ DEF FIRST In { go IS start p IS q } DEF LAST In { gone IS end p IS q } ] }
      ROUTE FIRST.gone TO LAST.go }
    DEF A Out { } DEF X Transform { }
    ROUTE X.center TO A.start
    ROUTE A.end TO X.center
    ROUTE A.q TO A.q)"),
              ElementsAre("FIRST.translation > LAST.translation", "X.center > FIRST.translation",
                          "LAST.translation > X.center", "FIRST.scale > FIRST.scale", "FIRST.scale > LAST.scale",
                          "LAST.scale > FIRST.scale", "LAST.scale > LAST.scale"));
}

// An event that nothing in the PROTO has is still one that may be routed; it goes nowhere.
TEST(RouteToAnInstance, MayEndNowhere) {
  EXPECT_THAT(
      routes("PROTO P [ eventIn SFBool on ] { Group { } } DEF A P { } DEF S TouchSensor { } ROUTE S.isOver TO A.on"),
      IsEmpty());
}

TEST(RouteToAnInstance, ReachesLaterNodesOfTheBody) {
  EXPECT_THAT(routes("PROTO P [ eventIn SFBool on ] { Group { } DEF T TimeSensor { enabled IS on } }\n"
                     "DEF A P { } DEF S TouchSensor { } ROUTE S.isOver TO A.on"),
              ElementsAre("S.isOver > T.enabled"));
}

class BadRoute : public testing::TestWithParam<BadCase> {};
TEST_P(BadRoute, IsReportedWhereItIs) { EXPECT_EQ(problems_of(kNodes + GetParam().body), GetParam().problems); }
INSTANTIATE_TEST_SUITE_P(
    Table, BadRoute,
    testing::Values(
        BadCase{"OtherType",
                "ROUTE T.fraction_changed TO X.translation",
                {"3:31: this ROUTE goes from SFFloat to SFVec3f: both must be of one type"}},
        BadCase{"ListForOne",
                "DEF C CoordinateInterpolator { } ROUTE I.value_changed TO C.keyValue",
                {"3:61: this ROUTE goes from SFVec3f to MFVec3f: both must be of one type"}},
        BadCase{"FromAField",
                "ROUTE X.bboxSize TO Y.scale",
                {"3:9: 'bboxSize' is a field of Transform: it sends no events"}},
        BadCase{"ToAField",
                "ROUTE X.scale TO Y.bboxSize",
                {"3:20: 'bboxSize' is a field of Transform: it takes no events"}},
        BadCase{"FromAnEventIn",
                "ROUTE I.set_fraction TO I.set_fraction",
                {"3:9: 'set_fraction' is an eventIn of PositionInterpolator: it sends no events"}},
        BadCase{"ToAnEventOut",
                "ROUTE S.isActive TO T.isActive",
                {"3:23: 'isActive' is an eventOut of TimeSensor: it takes no events"}},
        BadCase{"FromTheSetOfAnExposedField",
                "ROUTE X.set_scale TO Y.scale",
                {"3:9: Transform sends no event 'set_scale'"}},
        BadCase{"ToTheChangedOfAnExposedField",
                "ROUTE X.scale TO Y.scale_changed",
                {"3:20: Transform takes no event 'scale_changed'"}},
        BadCase{"UnknownEvent",
                "ROUTE X.scael TO Y.scale",
                {"3:9: Transform sends no event 'scael', did you mean 'scale'?"}},
        BadCase{"UnknownNode",
                "ROUTE XX.scale TO Y.scale",
                {"3:7: ROUTE names 'XX', which no DEF before it names, did you mean 'X'?"}},
        BadCase{"NotYetDefined",
                "ROUTE X.scale TO LATER.scale\nDEF LATER Transform { }",
                {"3:18: ROUTE names 'LATER', which no DEF before it names"}},
        BadCase{"BothEndsWrong",
                "ROUTE X.no TO Y.not",
                {"3:9: Transform sends no event 'no'", "3:17: Transform takes no event 'not'"}},
        BadCase{"WithoutTo",
                "ROUTE X.scale Y.scale\nShpae { }",
                {"3:15: expected TO and where the ROUTE goes, found 'Y'",
                 "4:1: unknown node type 'Shpae', did you mean 'Shape'?"}},
        BadCase{"WithoutPeriod",
                "ROUTE X scale TO Y.scale\nShpae { }",
                {"3:9: expected '.' and an event of 'X', found 'scale'",
                 "4:1: unknown node type 'Shpae', did you mean 'Shape'?"}},
        BadCase{"WithoutNames",
                "ROUTE TO",
                {"3:7: expected NODE.EVENT of a ROUTE, found 'TO'",
                 "3:9: expected NODE.EVENT of a ROUTE, found the end of the file"}},
        BadCase{"WithoutAnEvent", "ROUTE X. TO Y.scale\nGroup { }", {"3:10: expected an event of 'X', found 'TO'"}},
        // The content of an Inline is no event that the Inline has.
        BadCase{"ToWhatAnInlineHolds",
                "DEF N Inline { } DEF G Group { } ROUTE G.children TO N.children",
                {"3:56: Inline takes no event 'children'"}}),
    [](const auto& bad) { return std::string(bad.param.name); });

// The node is lost in an error, and the consequences of that are not reported again.
TEST(RouteToALostNode, IsNotReportedAgain) {
  EXPECT_THAT(problems_of("DEF A Shpae { } DEF B Group { }\nROUTE A.x TO B.addChildren ROUTE B.children TO A.y"),
              ElementsAre(HasSubstr("2:7: unknown node type 'Shpae'")));
  EXPECT_THAT(problems_of("Grop { children DEF A Transform { } } DEF B Transform { }\nROUTE A.scale TO B.scale"),
              ElementsAre(HasSubstr("2:1: unknown node type 'Grop'")));
  EXPECT_THAT(errors_of("PROTO P [ eventOut SFBool b ] { } DEF A P { } DEF B TimeSensor { }\nROUTE A.b TO B.loop"),
              IsEmpty());
}

}  // namespace peerd::vrml::route_parser_test
