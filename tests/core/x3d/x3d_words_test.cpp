#include "core/x3d/x3d_words.hpp"

#include <gmock/gmock.h>

#include "tests/core/gzip_text.hpp"
#include "tests/core/x3d/same_worlds.hpp"
#include "tests/core/x3d/x3d_fixture.hpp"

namespace peerd::vrml::x3d_words_test {

using testing::ElementsAre;
using testing::HasSubstr;

const NamedFiles kBeside = {{"in.wrl", kInlinedFile}, {"lib.wrl", kLibraryFile}};

// The three languages give one world, packed or not.
TEST(X3dWords, SayTheSameWorldAsVrml97) {
  const ReadResult vrml = formats::read_file("a.wrl", kInVrml97, kBeside);
  ASSERT_TRUE(vrml.scene);
  EXPECT_GT(vrml.scene->instances.size(), 30U);
  EXPECT_EQ(vrml.scene->document->routes.size(), 7U);
  for (const auto& [name, text] : {std::pair("a.x3dv", kInClassic), std::pair("a.x3d", kInXml)}) {
    EXPECT_EQ(difference_of(vrml, formats::read_file(name, text, kBeside)), "") << name;
    const std::string packed = gzipped(text);
    EXPECT_EQ(difference_of(vrml, formats::read_file(std::string(name) + "z", packed, kBeside)), "") << name;
  }
  EXPECT_EQ(written(formats::read_file("a.x3dv", kInClassic, kBeside)), written(vrml));
}

TEST(X3dWords, NameFieldsAndAccessesAnew) {
  EXPECT_EQ(vrml_field_name("Switch", "children"), "choice");
  EXPECT_EQ(vrml_field_name("LOD", "children"), "level");
  EXPECT_EQ(vrml_field_name("Collision", "enabled"), "collide");
  EXPECT_EQ(vrml_field_name("Group", "children"), "children");
  EXPECT_EQ(find_x3d_access("inputOutput"), Access::kExposedField);
  EXPECT_EQ(find_x3d_access("eventIn"), Access::kEventIn);
  EXPECT_EQ(find_x3d_access("inputoutput"), std::nullopt);
  EXPECT_EQ(x3d_name_of(Access::kField), "initializeOnly");
  EXPECT_EQ(container_of("MovieTexture"), "texture");
  EXPECT_EQ(container_of("Shape"), "children");
  EXPECT_EQ(container_of("ComposedShader"), "shaders");
}

TEST(X3dWords, ReadGroupsOfOtherNamesAsGroups) {
  EXPECT_EQ(difference_of(read_vrml97("Group { children Shape { geometry Box { } } }"),
                          read_classic("StaticGroup { children Shape { geometry Box { } } }")),
            "");
  EXPECT_EQ(
      difference_of(
          read_vrml97("Group { children Transform { translation 1 2 3 children Group { children Shape { } } } }"),
          read_xml("<CADAssembly><CADPart translation='1 2 3'><CADFace><Shape/></CADFace></CADPart></CADAssembly>")),
      "");
}

// The nodes of X3D that no document keeps are named, and are no reason to refuse a world; a misspelt one is.
TEST(X3dWords, KnowNodesThatAreNotKept) {
  const ReadResult left_out =
      read_classic("Group { children [ DEF R RigidBody { mass 3 } USE R Shape { } ] }\nKeySensor { }");
  ASSERT_TRUE(left_out.scene);
  EXPECT_THAT(
      warnings_of(left_out),
      ElementsAre("a.x3dv:2: RigidBody is a node of X3D that is not read; the node is left out, with all that is in it",
                  "a.x3dv:2: 'R' is a node that was left out; a USE of it is empty, a ROUTE is left out",
                  HasSubstr("a.x3dv:3: KeySensor is a node of X3D")));
  EXPECT_EQ(paths_of(*left_out.scene), (std::vector<std::string>{"0", "0/2"}));
  EXPECT_THAT(error_of(read_classic("RigidBodi { }")), HasSubstr("unknown node type 'RigidBodi'"));
  EXPECT_THAT(error_of(read_vrml97("RigidBody { }")), HasSubstr("unknown node type 'RigidBody'"));
}

TEST(X3dWords, DeclareScriptsWithInputOutput) {
  const ReadResult x3d = read_classic(
      "DEF A ScalarInterpolator { }\nPROTO P [ inputOutput SFFloat q 1 ] { Script { inputOutput SFFloat v IS q } }\n"
      "DEF S Script { inputOutput SFFloat v 3 }\nDEF I P { q 5 }\n"
      "ROUTE A.value_changed TO S.v\nROUTE S.v TO A.set_fraction\nROUTE A.value_changed TO I.set_q\nROUTE I.q_changed "
      "TO A.set_fraction");
  const ReadResult vrml = read_vrml97(
      "DEF A ScalarInterpolator { }\n"
      "DEF S Script { field SFFloat v 3 eventIn SFFloat set_v eventOut SFFloat v_changed }\n"
      "DEF I Script { field SFFloat v 5 eventIn SFFloat set_v eventOut SFFloat v_changed }\n"
      "ROUTE A.value_changed TO S.set_v\nROUTE S.v_changed TO A.set_fraction\n"
      "ROUTE A.value_changed TO I.set_v\nROUTE I.v_changed TO A.set_fraction");
  EXPECT_EQ(difference_of(vrml, x3d), "");
}

TEST(X3dWords, NameTypesThatAreNotKeptOnce) {
  const ReadResult result = read_classic(
      "PROTO P [ initializeOnly SFVec3d gone 1 2 3 inputOutput SFColorRGBA c 1 1 1 1 ] { Script { inputOutput "
      "SFColorRGBA d IS c } }\n"
      "DEF I P { gone 1 2 3 c 0 0 0 0 }\nDEF A ScalarInterpolator { }\nROUTE A.value_changed TO I.gone");
  ASSERT_TRUE(result.scene) << result.diagnostics.at(0).message;
  EXPECT_THAT(
      warnings_of(result),
      ElementsAre(HasSubstr("a.x3dv:2: 'gone' is left out: its type SFVec3d, of X3D, is not kept"),
                  HasSubstr("a.x3dv:2: 'c' is left out"), HasSubstr("a.x3dv:2: Scripts are kept"),
                  HasSubstr("a.x3dv:2: 'd' is left out"),
                  HasSubstr("a.x3dv:5: 'gone' of P is a field of X3D that is not kept; the ROUTE is left out")));
}

TEST(X3dWords, BringNodesOfInlinesIntoRoutes) {
  const NamedFiles beside = {
      {"b.x3dv", "#X3D V3.3 utf8\nDEF A Transform { }\nEXPORT A AS part\nEXPORT B\n"},
      {"c.x3d", "<X3D><Scene><Transform DEF='A'/><EXPORT localDEF='A' AS='part'/></Scene></X3D>"}};
  const char* const expected =
      "DEF P PositionInterpolator { }\nDEF I Group { children DEF A Transform { } }\nROUTE P.value_changed TO "
      "A.translation";
  for (const char* const file : {"b.x3dv", "c.x3d"}) {
    const std::string inlined = "DEF I Inline { url \"" + std::string(file) + "\" }\n";
    const ReadResult classic = read_classic(
        "DEF P PositionInterpolator { }\n" + inlined + "IMPORT I.part AS it\nROUTE P.value_changed TO it.translation",
        beside);
    EXPECT_EQ(difference_of(classic, read_vrml97(expected)), "") << file;
    const ReadResult xml =
        read_xml("<PositionInterpolator DEF='P'/><Inline DEF='I' url='\"" + std::string(file) +
                     "\"'/><IMPORT inlineDEF='I' importedDEF='part' AS='it'/>"
                     "<ROUTE fromNode='P' fromField='value_changed' toNode='it' toField='translation'/>",
                 beside);
    EXPECT_EQ(difference_of(xml, read_vrml97(expected)), "") << file;
  }
  const ReadResult lost = read_classic(
      "DEF P PositionInterpolator { }\nDEF I Inline { url \"b.x3dv\" }\nIMPORT I.none\nIMPORT P.x\n"
      "ROUTE P.value_changed TO none.translation",
      beside);
  ASSERT_TRUE(lost.scene);
  EXPECT_THAT(warnings_of(lost), ElementsAre("a.x3dv:4: this IMPORT is left out: the file of 'I' exports no 'none'",
                                             HasSubstr("a.x3dv:5: this IMPORT is left out: 'P' is no Inline"),
                                             HasSubstr("a.x3dv:6: 'none' is a node that was left out"),
                                             HasSubstr("b.x3dv:4: EXPORT of 'B', which no DEF names")));
}

// A world of VRML97 may take PROTOs and Inlines from X3D, and the other way round.
TEST(X3dWords, StandInFilesOfOtherWorlds) {
  const NamedFiles beside = {
      {"p.x3d",
       "<X3D><Scene><ProtoDeclare name='Q'><ProtoInterface><field accessType='initializeOnly' type='SFFloat' "
       "name='s' value='1'/></ProtoInterface><ProtoBody><Shape><Sphere><IS><connect nodeField='radius' "
       "protoField='s'/></IS></Sphere></Shape></ProtoBody></ProtoDeclare><Shape/></Scene></X3D>"}};
  const ReadResult world =
      read_vrml97("EXTERNPROTO Q [ field SFFloat s ] \"p.x3d\"\nQ { s 3 }\nInline { url \"p.x3d\" }", beside);
  EXPECT_EQ(difference_of(world, read_vrml97("Shape { geometry Sphere { radius 3 } }\nGroup { children Shape { } }")),
            "");
}

// ISO/IEC 19775-1, 23.4.4 and 17.4.3.
TEST(X3dWords, HaveTheDefaultsOfX3d) {
  const std::string given =
      "NavigationInfo { type [ \"EXAMINE\" \"ANY\" ] }\n"
      "SpotLight { beamWidth 0.7853982 cutOffAngle 1.5707964 }\n";
  EXPECT_EQ(difference_of(read_vrml97(given), read_classic("NavigationInfo { }\nSpotLight { }")), "");
  EXPECT_EQ(difference_of(read_vrml97(given), read_xml("<NavigationInfo/><SpotLight/>")), "");
  EXPECT_EQ(difference_of(read_vrml97("SpotLight { beamWidth 0.5 cutOffAngle 0.25 }"),
                          read_classic("PROTO P [ initializeOnly SFFloat a 0.5 ] { SpotLight { beamWidth IS a "
                                       "cutOffAngle 0.25 } }\nP { }")),
            "");
}

TEST(X3dWords, ScriptsHaveAValueWhereTheirIsBringsNone) {
  EXPECT_EQ(difference_of(read_vrml97("Script { field SFVec3f a 0 0 0 eventIn SFVec3f set_a eventOut SFVec3f a_changed "
                                      "field SFRotation r 0 0 1 0 }"),
                          read_classic("PROTO P [ inputOnly SFVec3f u initializeOnly SFVec3d q 1 2 3 ] { Script { "
                                       "inputOutput SFVec3f a IS u initializeOnly SFRotation r IS q } }\nP { }")),
            "");
}

TEST(X3dWords, ScriptsMayDeclareTheEventsOfAnInputOutput) {
  const ReadResult result = read_classic("Script { inputOnly SFFloat set_a inputOutput SFFloat a 1 }");
  EXPECT_EQ(difference_of(read_vrml97("Script { eventIn SFFloat set_a field SFFloat a 1 eventOut SFFloat a_changed }"),
                          result),
            "");
  EXPECT_TRUE(read_vrml97(written(result).substr(std::string("#VRML V2.0 utf8\n").size())).scene);
}

TEST(X3dWords, NameAnImportThatMovesSeveralInlines) {
  const NamedFiles files = {{"b.x3dv", "#X3D V3.3 utf8\nDEF N Transform { }\nEXPORT N\n"}};
  const std::string imports = "DEF I Inline { url \"b.x3dv\" }\nIMPORT I.N\n";
  EXPECT_THAT(warnings_of(read_classic(imports, files)), testing::IsEmpty());
  EXPECT_THAT(
      warnings_of(read_classic(imports + "Inline { url \"b.x3dv\" }", files)),
      testing::ElementsAre("a.x3dv:3: what this IMPORT does to the file of an Inline, it does to all Inlines of "
                           "that file"));
}

TEST(X3dWords, OfTheHeadStandInFrontOfNodes) {
  EXPECT_FALSE(read_classic("Group { UNIT length mm 0.001 }").scene);
  EXPECT_FALSE(read_classic("Group { PROFILE Interchange }").scene);
}

}  // namespace peerd::vrml::x3d_words_test
