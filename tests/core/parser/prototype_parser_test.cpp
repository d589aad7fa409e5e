// These tests are about PROTO (ISO/IEC 14772-1:1997, 4.3.5, 4.3.6 and 4.8).
#include "core/parser/prototype_parser.hpp"

#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd::vrml::prototype_parser_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Numbers = std::vector<float>;

// 4.8.2: each instance is a complete copy, with its own fields.
TEST(Proto, GivesEachInstanceItsOwnFields) {
  const Scene scene = scene_of(R"(
    PROTO Ball [ field SFFloat r 2 ] { Shape { geometry Sphere { radius IS r } } }
    Ball { } Ball { r 3 } Ball { })");
  EXPECT_THAT(floats_of(*scene.document, "Sphere", "radius"), ElementsAre(Numbers{2}, Numbers{3}, Numbers{2}));
  EXPECT_EQ(document_violation(*scene.document), "");
  ASSERT_EQ(scene.instances.size(), 3u);
  EXPECT_NE(scene.instances[0].node, scene.instances[2].node);
  // Geometry of the same values is kept once.
  EXPECT_EQ(scene.geometries.size(), 2u);
  EXPECT_EQ(scene.instances[0].geometry, scene.instances[2].geometry);
  EXPECT_EQ(std::get<SphereGeometry>(*scene.geometry(ObjectId{1})).radius, 3.0f);
}

// 4.8.3: the first node says where an instance may stand.
TEST(Proto, StandsWhereItsFirstNodeMay) {
  EXPECT_THAT(problems_of(R"(
    PROTO Paint [ ] { Material { } }
    PROTO Form [ ] { Box { } }
    PROTO Points [ ] { Coordinate { point [ 0 0 0, 1 0 0, 1 1 0 ] } }
    Shape { appearance Appearance { material Paint { } } geometry Form { } }
    Shape { geometry IndexedFaceSet { coord Points { } coordIndex [ 0 1 2 ] } })"),
              IsEmpty());
  EXPECT_THAT(problems_of("PROTO Paint [ ] { Material { } }\nGroup { children Paint { } }"),
              ElementsAre(HasSubstr("3:18: 'children' takes a child of a group")));
  EXPECT_THAT(problems_of("PROTO Thing [ ] { Group { } }\nShape { geometry Thing { } }"),
              ElementsAre(HasSubstr("3:18: 'geometry' takes a geometry node")));
  EXPECT_THAT(problems_of("PROTO A [ ] { Material { } } PROTO B [ ] { A { } }\nShape { geometry B { } }"),
              ElementsAre(HasSubstr("3:18: 'geometry' takes a geometry node")));
}

// 4.8.3: other nodes are no part of the hierarchy, but ROUTEs and Scripts reach them.
TEST(Proto, KeepsLaterNodesOutOfTheScene) {
  const Scene scene = scene_of(R"(
    PROTO Door [ ] {
      Transform { children Shape { geometry Box { } } }
      DEF CLOCK TimeSensor { }
      Shape { geometry Sphere { } }
      Transform { children Shape { } }
    }
    DEF D Door { })");
  EXPECT_THAT(paths_of(scene), ElementsAre("D", "D/0"));
  EXPECT_EQ(nodes_of_type(*scene.document, "TimeSensor").size(), 1u);
  EXPECT_EQ(nodes_of_type(*scene.document, "Sphere").size(), 1u);
}

TEST(Proto, PassesValuesThroughTwoLevels) {
  const Scene scene = scene_of(R"(
    PROTO Inner [ exposedField SFVec3f p 1 1 1 field SFFloat r 7 ] {
      Transform { translation IS p children Shape { geometry Sphere { radius IS r } } } }
    PROTO Outer [ exposedField SFVec3f q 2 2 2 field SFFloat s 8 ] {
      Group { children [ Inner { p IS q } Inner { r IS s } Inner { p IS q r IS s } ] } }
    Outer { }
    Outer { q 3 3 3 s 9 })");
  EXPECT_THAT(floats_of(*scene.document, "Transform", "translation"),
              ElementsAre(Numbers{2, 2, 2}, Numbers{1, 1, 1}, Numbers{2, 2, 2},  //
                          Numbers{3, 3, 3}, Numbers{1, 1, 1}, Numbers{3, 3, 3}));
  EXPECT_THAT(floats_of(*scene.document, "Sphere", "radius"),
              ElementsAre(Numbers{7}, Numbers{8}, Numbers{8}, Numbers{7}, Numbers{9}, Numbers{9}));
  EXPECT_EQ(document_violation(*scene.document), "");
}

// 4.8.3: one interface field may be that of many nodes.
TEST(Proto, FillsAllThatIsAField) {
  const Scene scene = scene_of(R"(
    PROTO Pair [ field SFFloat r 2 field MFNode kids [ ] ] {
      Group { children [ Shape { geometry Sphere { radius IS r } } Shape { geometry Cone { height IS r } }
                         Group { children IS kids } Transform { children IS kids } ] } }
    Pair { r 5 kids [ DEF K Shape { } ] })");
  EXPECT_THAT(floats_of(*scene.document, "Sphere", "radius"), ElementsAre(Numbers{5}));
  EXPECT_THAT(floats_of(*scene.document, "Cone", "height"), ElementsAre(Numbers{5}));
  EXPECT_THAT(paths_of(scene), ElementsAre("0", "0/0", "0/1", "0/2", "0/2/K", "0/3", "0/3/K"));
  EXPECT_EQ(scene.instances[4].node, scene.instances[6].node) << "one node in two places, as by USE";
}

TEST(Proto, CopiesTheNodesOfItsDefaults) {
  const Scene scene = scene_of(R"(
    PROTO Box2 [ field MFNode kids [ DEF K Shape { geometry Box { } } USE K ] field SFNode look NULL ] {
      Transform { children [ Group { children IS kids } Shape { appearance IS look } ] } }
    Box2 { } Box2 { kids [ ] } Box2 { look Appearance { } })");
  EXPECT_THAT(paths_of(scene), ElementsAre("0", "0/0", "0/0/K", "0/0/1", "0/1",  //
                                           "1", "1/0", "1/1",                    //
                                           "2", "2/0", "2/0/K", "2/0/1", "2/1"));
  EXPECT_EQ(scene.instances[2].node, scene.instances[3].node);
  EXPECT_NE(scene.instances[2].node, scene.instances[10].node);
  EXPECT_EQ(document_violation(*scene.document), "");
}

TEST(Proto, HasDefaultsOfInstancesOfOtherProtos) {
  const Scene scene = scene_of(R"(
    PROTO Wheel [ field SFFloat r 1 ] { Shape { geometry Sphere { radius IS r } } }
    PROTO Car [ field MFNode wheels [ Wheel { r 4 } Wheel { } ] ] { Group { children IS wheels } }
    Car { }
    Car { wheels Wheel { r 6 } })");
  EXPECT_EQ(scene.instances.size(), 5u);
  std::vector<float> radii;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    if (const Geometry* g = scene.geometry(ObjectId{i})) radii.push_back(std::get<SphereGeometry>(*g).radius);
  }
  EXPECT_THAT(radii, ElementsAre(4, 1, 6));
}

// All field types are carried both ways: from the default and from the instance.
TEST(Proto, CarriesEveryFieldType) {
  const Scene scene = scene_of(R"(
    PROTO All [
      field SFBool b TRUE field SFColor c 1 0 0 field SFFloat f 2 field SFImage i 1 1 1 7 field SFInt32 n 3
      field SFNode node NULL field SFRotation r 0 0 1 2 field SFString s "x" field SFTime t 4 field SFVec2f v2 5 6
      field SFVec3f v3 7 8 9 field MFColor mc [ 1 0 0 ] field MFFloat mf [ 1 2 ] field MFInt32 mi [ 3 4 ]
      field MFNode mn [ ] field MFRotation mr [ 0 0 1 2 ] field MFString ms [ "a" "b" ] field MFTime mt [ 1 2 ]
      field MFVec2f mv2 [ 1 2 ] field MFVec3f mv3 [ 1 2 3 ] ] {
      Script {
        field SFBool b IS b field SFColor c IS c field SFFloat f IS f field SFImage i IS i field SFInt32 n IS n
        field SFNode node IS node field SFRotation r IS r field SFString s IS s field SFTime t IS t
        field SFVec2f v2 IS v2 field SFVec3f v3 IS v3 field MFColor mc IS mc field MFFloat mf IS mf
        field MFInt32 mi IS mi field MFNode mn IS mn field MFRotation mr IS mr field MFString ms IS ms
        field MFTime mt IS mt field MFVec2f mv2 IS mv2 field MFVec3f mv3 IS mv3 } }
    All { }
    All { b FALSE c 0 1 0 f 3 i 1 1 1 8 n 4 node Box { } r 0 1 0 3 s "y" t 5 v2 6 7 v3 8 9 10 mc [ ] mf 5 mi [ 6 ]
          mn [ Group { } ] mr 1 0 0 1 ms "c" mt 9 mv2 [ 3 4 5 6 ] mv3 [ ] })");
  const auto scripts = nodes_of_type(*scene.document, "Script");
  ASSERT_EQ(scripts.size(), 2u);
  EXPECT_EQ(document_violation(*scene.document), "");
  const Node& first = scene.document->nodes[scripts[0]];
  const Node& second = scene.document->nodes[scripts[1]];
  const auto get = [](const Node& node, std::string_view field) -> const Field& { return *node.find(field); };
  EXPECT_TRUE(get(first, "b").as<bool>()[0]);
  EXPECT_FALSE(get(second, "b").as<bool>()[0]);
  EXPECT_THAT(get(first, "i").as<std::int32_t>(), ElementsAre(1, 1, 1, 7));
  EXPECT_THAT(get(second, "i").as<std::int32_t>(), ElementsAre(1, 1, 1, 8));
  EXPECT_EQ(get(second, "n").as<std::int32_t>()[0], 4);
  EXPECT_EQ(get(first, "node").count, 0u);
  EXPECT_EQ(scene.document->nodes[get(second, "node").as<NodeRef>()[0].index].type->name, "Box");
  EXPECT_EQ(get(second, "s").as<std::string_view>()[0], "y");
  EXPECT_EQ(get(first, "t").as<double>()[0], 4.0);
  EXPECT_EQ(floats(second, "r"), (Numbers{0, 1, 0, 3}));
  EXPECT_EQ(floats(first, "v2"), (Numbers{5, 6}));
  EXPECT_EQ(get(second, "mc").count, 0u);
  EXPECT_EQ(floats(second, "mf"), (Numbers{5}));
  EXPECT_THAT(get(first, "mi").as<std::int32_t>(), ElementsAre(3, 4));
  EXPECT_EQ(get(second, "mn").count, 1u);
  EXPECT_EQ(floats(second, "mr"), (Numbers{1, 0, 0, 1}));
  EXPECT_THAT(get(first, "ms").as<std::string_view>(), ElementsAre("a", "b"));
  EXPECT_THAT(get(second, "mt").as<double>(), ElementsAre(9.0));
  EXPECT_EQ(floats(second, "mv2"), (Numbers{3, 4, 5, 6}));
  EXPECT_EQ(floats(first, "mv3"), (Numbers{1, 2, 3}));
}

class BadProto : public testing::TestWithParam<BadCase> {};
TEST_P(BadProto, IsReportedWhereItIs) { EXPECT_EQ(problems_of(GetParam().body), GetParam().problems); }

INSTANTIATE_TEST_SUITE_P(
    Scope, BadProto,
    testing::Values(
        // 4.8.4: names of a body and of the file around it don't see each other.
        BadCase{"UseOfAnInnerName",
                "PROTO P [ ] { DEF IN Group { } }\nP { }\nUSE IN",
                {"4:5: USE of 'IN', which no DEF before it names"}},
        BadCase{"UseOfAnOuterName",
                "DEF OUT Group { }\nPROTO P [ ] { Group { children USE OUT } }",
                {"3:36: USE of 'OUT', which no DEF before it names"}},
        BadCase{"UseOfANameOfTheProtoAround",
                "PROTO A [ ] { DEF X Group { }\n PROTO B [ ] { Group { children USE X } } B { } }",
                {"3:37: USE of 'X', which no DEF before it names"}},
        BadCase{"RouteToAnInnerName",
                "PROTO P [ ] { DEF T TouchSensor { } }\nP { }\nROUTE T.isOver TO T.enabled",
                {"4:7: ROUTE names 'T', which no DEF before it names",
                 "4:19: ROUTE names 'T', which no DEF before it names"}},
        BadCase{"NestedProtoOutside",
                "PROTO A [ ] { PROTO Bead [ ] { Group { } } Bead { } }\nBead { }",
                {"3:1: unknown node type 'Bead'"}},
        BadCase{"BeforeItsDefinition", "Bead { }\nPROTO Bead [ ] { Group { } }", {"2:1: unknown node type 'Bead'"}},
        // 4.8.4: recursive prototypes are illegal.
        BadCase{"InItself",
                "PROTO Russian [ ] { Group { children Russian { } } }",
                {"2:38: 'Russian' is used inside its own PROTO: it would contain itself"}},
        BadCase{"InAProtoInItself",
                "PROTO A [ ] { PROTO B [ ] { Group { children A { } } } B { } }",
                {"2:46: 'A' is used inside its own PROTO: it would contain itself"}}),
    [](const auto& bad) { return std::string(bad.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Names, BadProto,
    testing::Values(
        BadCase{"OfTheStandard",
                "PROTO Box [ ] { Group { } }",
                {"2:7: 'Box' is a node of the standard: no PROTO can take its name"}},
        BadCase{"Twice",
                "PROTO P [ ] { Group { } }\nPROTO P [ ] { Shape { } }\nP { }",
                {"warning 3:7: a PROTO 'P' is there already; this one counts from here on"}},
        BadCase{"Keyword", "PROTO USE [ ] { Group { } }\nGroup { }", {"2:7: expected a name after PROTO, found 'USE'"}},
        BadCase{"Missing", "PROTO [ ] { Group { } }\nGroup { }", {"2:7: expected a name after PROTO, found '['"}},
        // 4.3.5: names are unique, and an exposedField x takes set_x and x_changed too.
        BadCase{"FieldTwice",
                "PROTO P [ field SFBool a TRUE\n field SFBool a FALSE ] { Group { } }",
                {"3:15: 'a' is in the interface of 'P' already"}},
        BadCase{"KeywordAsFieldName",
                "PROTO P [ field SFBool USE TRUE ] { Group { } }",
                {"2:24: expected the name of a field, found 'USE'"}}),
    [](const auto& bad) { return std::string(bad.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Instances, BadProto,
    testing::Values(
        BadCase{"UnknownField",
                "PROTO Car [ field SFFloat speed 1 ] { Group { } }\nCar { sped 2 }",
                {"3:7: Car has no field 'sped', did you mean 'speed'?"}},
        BadCase{"FieldOfItsFirstNode",
                "PROTO Car [ ] { Transform { } }\nCar { translation 1 2 3 }",
                {"3:7: Car has no field 'translation'"}},
        BadCase{"ValueForAnEvent",
                "PROTO Car [ eventIn SFFloat go eventOut SFFloat gone ] { Group { } }\nCar { go 1 gone 2 }",
                {"3:7: 'go' is an eventIn of Car: a file cannot give it a value",
                 "3:12: 'gone' is an eventOut of Car: a file cannot give it a value"}},
        BadCase{"ValueOfAnotherType",
                "PROTO Car [ field SFFloat speed 1 ] { Group { } }\nCar { speed \"fast\" }",
                {"3:13: 'speed' (SFFloat) wants a number, found the string \"fast'"}},
        BadCase{"ValueOutOfRange",
                "PROTO Ball [ field SFFloat r 1 ] { Shape { geometry Sphere { radius IS r } } }\nBall { r -1 }",
                {"3:10: 'radius' must be > 0, found '-1'"}},
        BadCase{"DefaultOutOfRange",
                "PROTO Ball [\n field SFFloat r -1 ] { Shape { geometry Sphere { radius IS r } } }\nBall { } Ball { }",
                {"3:18: 'radius' must be > 0, found '-1'"}},
        BadCase{"NodeOfAnotherClass",
                "PROTO Bag [ field MFNode kids [ ] ] { Group { children IS kids } }\nBag { kids [ Shape { }\n Material "
                "{ } ] }",
                {"warning 4:2: 'children' takes a child of a group; Material is a Material; here it has no effect"}},
        BadCase{"DefaultNodeOfAnotherClass",
                "PROTO Bag [ field SFNode look\n Box { } ] { Shape { appearance IS look } }\nBag { }",
                {"3:2: 'appearance' takes an Appearance; Box is a geometry node"}},
        BadCase{"UseOfItself",
                "PROTO Bag [ field MFNode kids [ ] ] { Group { children IS kids } }\nDEF B Bag { kids USE B }",
                {"3:22: USE of 'B' inside that node itself: a node cannot contain itself"}}),
    [](const auto& bad) { return std::string(bad.param.name); });

TEST(ProtoScope, SeesProtosBeforeIt) {
  EXPECT_THAT(errors_of(R"(
    PROTO A [ ] { Shape { } }
    PROTO B [ ] { PROTO C [ ] { Group { children A { } } } Group { children [ A { } C { } ] } }
    B { })"),
              IsEmpty());
}

// 4.3.3: PROTOs may stand in a node's body.
TEST(ProtoScope, MayBeginInsideANode) {
  const Scene scene =
      scene_of("Group { PROTO P [ ] { Shape { } } children [ P { } PROTO Q [ ] { Group { } } Q { } ] } P { }");
  EXPECT_EQ(scene.instances.size(), 4u);
}

TEST(ProtoScope, KeepsEqualNamesApart) {
  const Scene scene = scene_of(R"(
    DEF A Transform { translation 1 0 0 }
    PROTO P [ ] { Group { children [ DEF A Transform { translation 2 0 0 } USE A ] } }
    P { }
    USE A)");
  EXPECT_EQ(scene.transform(ObjectId{0}).translation.x(), 1);
  EXPECT_EQ(scene.transform(ObjectId{2}).translation.x(), 2);
  EXPECT_EQ(scene.transform(ObjectId{3}).translation.x(), 2);
  EXPECT_EQ(scene.transform(ObjectId{4}).translation.x(), 1);
  // The world's name comes first, wherever the other one stands.
  EXPECT_EQ(scene.find("A"), ObjectId{0});
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i)
    EXPECT_EQ(scene.find(scene.path_of(ObjectId{i})), ObjectId{i});
}

// A default value is written in the file around the PROTO, so it sees that file's names; each instance has its copy.
TEST(ProtoScope, LetsDefaultsUseWhatStandsBefore) {
  const Scene scene = scene_of(R"(
    DEF S Shape { geometry DEF G Box { } }
    PROTO P [ field MFNode kids [ USE S USE S ] field SFNode form USE G ] {
      Group { children [ Group { children IS kids } Shape { geometry IS form } ] } }
    P { } P { })");
  EXPECT_EQ(document_violation(*scene.document), "");
  EXPECT_EQ(scene.instances.size(), 1u + 2 * 5u);
}

TEST(ProtoInstance, CanBeDefinedAndUsed) {
  const Scene scene = scene_of(R"(
    PROTO P [ field SFVec3f p 0 0 0 ] { DEF INSIDE Transform { translation IS p children DEF KID Shape { } } }
    DEF A P { p 1 2 3 }
    Transform { children USE A })");
  EXPECT_THAT(paths_of(scene), ElementsAre("A", "A/KID", "1", "1/A", "1/A/KID"));
  EXPECT_EQ(scene.instances[0].node, scene.instances[3].node);
  EXPECT_EQ(scene.instances[0].def, "A");
  EXPECT_FALSE(scene.instances[0].inner_name);
  EXPECT_TRUE(scene.instances[1].inner_name);
}

TEST(ProtoInstance, OfTwoProtosInOneHasTheOutermostName) {
  const Scene scene = scene_of(R"(
    PROTO A [ ] { DEF ROOT Transform { } }
    PROTO B [ ] { DEF MID A { } }
    DEF TOP B { })");
  EXPECT_THAT(paths_of(scene), ElementsAre("TOP"));
  EXPECT_EQ(scene.find("TOP"), ObjectId{0});
}

TEST(ProtoInstance, CanHoldAnInstanceOfItsOwnType) {
  const Scene scene = scene_of(R"(
    PROTO Bag [ field MFNode kids [ ] ] { Group { children IS kids } }
    Bag { kids [ Bag { kids Bag { } } Bag { } ] })");
  EXPECT_THAT(paths_of(scene), ElementsAre("0", "0/0", "0/0/0", "0/1"));
  EXPECT_EQ(document_violation(*scene.document), "");
}

TEST(ProtoInstance, ChoosesASwitchsChild) {
  const Scene scene = scene_of(R"(
    PROTO Pick [ field SFInt32 n 0 ] { Switch { whichChoice IS n choice [ Shape { } Group { } ] } }
    Pick { } Pick { n 1 } Pick { n -1 })");
  EXPECT_THAT(solid_of(scene), ElementsAre("0", "0/0", "1", "1/1", "2"));
}

// A PROTO named as one of our own nodes is there for browsers that have no such node (4.9.4 wants a PROTO for those).
TEST(ProtoOfOurOwn, GivesWayToTheNode) {
  const Scene scene = scene_of(R"(
    PROTO CollisionInterest [ field SFString objectPath "" field MFString interests [ ] ] { Group { } }
    DEF A Group { } DEF B Group { }
    CollisionInterest { objectPath "A" interests "B" })");
  EXPECT_EQ(scene.interests.size(), 1u);
  EXPECT_EQ(scene.instances.size(), 2u);
  EXPECT_THAT(problems_of("PROTO KeySensor [ field SFFloat keyValue 1 ] { Group { } }"),
              ElementsAre(HasSubstr("KeySensor has 'keyValue' as SFInt32, not SFFloat")));
}

TEST(ProtoInterests, MeanTheirOwnInstancesNodes) {
  const Scene scene = scene_of(R"(
    DEF HIT Shape { }
    PROTO Car [ ] {
      DEF SELF Transform { children [ DEF HIT Shape { } CollisionInterest { objectPath "SELF" interests [ "HIT" "WALL" ] } ] } }
    Car { }
    DEF B Car { }
    DEF WALL Shape { })");
  ASSERT_EQ(scene.interests.size(), 2u);
  EXPECT_EQ(scene.interests[0].colliders.ends.front(), ObjectId{1});
  EXPECT_THAT(scene.interests[0].collidees.ends, ElementsAre(ObjectId{2}, ObjectId{5}));
  EXPECT_EQ(scene.interests[1].colliders.ends.front(), ObjectId{3});
  EXPECT_THAT(scene.interests[1].collidees.ends, ElementsAre(ObjectId{4}, ObjectId{5}));
}

TEST(ProtoInterests, TakeNamesFromTheInterface) {
  const Scene scene = scene_of(R"(
    PROTO Watch [ field SFString who "" field MFString whom [ ] ] { CollisionInterest { objectPath IS who interests IS whom } }
    DEF A Group { } DEF B Group { } DEF C Group { }
    Watch { who "A" whom [ "B" "C" ] })");
  ASSERT_EQ(scene.interests.size(), 1u);
  EXPECT_EQ(scene.interests[0].colliders.ends.front(), ObjectId{0});
  EXPECT_THAT(scene.interests[0].collidees.ends, ElementsAre(ObjectId{1}, ObjectId{2}));
}

// Errors inside a PROTO come once, not once for each instance.
TEST(ProtoErrors, AreNotRepeatedByInstances) {
  EXPECT_THAT(problems_of("PROTO P [ ] { Group { children Shpae { } } }\nP { } P { } P { }"),
              ElementsAre(HasSubstr("2:32: unknown node type 'Shpae'")));
  EXPECT_THAT(
      problems_of("PROTO P [ field SFFloat r x ] { Shape { geometry Sphere { radius IS r } } }\nP { } P { r 2 }")
          .size(),
      1u);
  EXPECT_THAT(errors_of("PROTO P [ ] { Shape { geometry IndexedFaceSet { coord Coordinate { point 0 0 0 } coordIndex [ "
                        "0 1 2 ] } } }\n"
                        "P { } P { } P { }")
                  .size(),
              2u)
      << "one for each index that is out of range";
}

// A default value that could not be read leaves its PROTO's instances without one, and the reader alive.
TEST(ProtoErrors, InDefaultsOfAnyTypeAreSurvived) {
  for (const char* body : {"PROTO P [ field SFFloat r x ] { Shape { geometry Sphere { radius IS r } } }\nP { }",
                           "PROTO P [ field SFVec3f v x ] { Transform { translation IS v scale IS v } }\nP { }",
                           "PROTO P [ field SFVec3f v x ] { Shape { geometry Box { size IS v } } }\nP { }",
                           "PROTO P [ field SFInt32 n x ] { Switch { whichChoice IS n } }\nP { }",
                           "PROTO P [ field SFBool b x ] { Collision { collide IS b } }\nP { }",
                           "PROTO P [ field SFString s x ] { CollisionInterest { objectPath IS s } }\nP { }",
                           "PROTO P [ field MFString u x ] { Inline { url IS u } }\nP { }",
                           "PROTO P [ field MFNode n x ] { Group { children IS n } }\nP { }",
                           "PROTO P [ field SFNode n x ] { Shape { geometry IS n } }\nP { }"}) {
    EXPECT_EXIT(std::_Exit(read_body(body).scene ? 1 : 0), testing::ExitedWithCode(0), "") << body;
  }
}

TEST(ProtoErrors, LeaveAllOthersToBeFound) {
  EXPECT_THAT(
      errors_of("PROTO P [ field SFVec3 a 1 2 3 ] { Transform { translation IS b } }\n"
                "PROTO Q [ ] { }\n"
                "Group { children [ P { } Q { } R { } ] }\nShape { x 1 }"),
      ElementsAre(HasSubstr("2:17:"), HasSubstr("2:63:"), HasSubstr("4:32: unknown node type 'R'"), HasSubstr("5:9:")));
}

TEST(ProtoNesting, HasALimit) {
  const auto nested = [](int depth) {
    std::string body;
    for (int i = 0; i < depth; ++i) body += "PROTO P" + std::to_string(i) + " [ ] { ";
    body += "Group { }";
    for (int i = depth; i-- > 0;) body += " } P" + std::to_string(i) + " { }";
    return body;
  };
  EXPECT_THAT(problems_of(nested(200)), IsEmpty());
  EXPECT_THAT(errors_of(nested(300)), testing::Contains(HasSubstr("nested more than 256 deep")));
}

// An event's IS gives a field no value, and takes none away.
TEST(Proto, LetsAFieldHaveAValueAndItsEventsAnInterface) {
  EXPECT_THAT(problems_of("PROTO P [ eventOut SFVec3f o eventIn SFVec3f i ] { Transform { translation 1 0 0 "
                          "translation_changed IS o set_translation IS i } }\nP { }"),
              IsEmpty());
}

// Copies of what a default USEs are counted before they are made.
TEST(MemoryLimit, CountsWhatDefaultsUse) {
  std::string body = "DEF X Group { children [ ";
  for (int i = 0; i < 2000; ++i) body += "Group { } ";
  body += "] }\nPROTO P [ ";
  for (int i = 0; i < 500; ++i) body += "field SFNode f" + std::to_string(i) + " USE X ";
  body += "] { Group { } }";
  ReadOptions options;
  options.limits.nodes = 10'000;
  const std::string text = world_text(body);
  const ReadResult result = read_world(text, options);
  EXPECT_FALSE(result.scene.has_value());
}

}  // namespace peerd::vrml::prototype_parser_test
