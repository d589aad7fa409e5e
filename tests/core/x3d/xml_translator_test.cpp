#include "core/x3d/xml_translator.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <string>

#include "tests/core/x3d/x3d_fixture.hpp"

namespace peerd::vrml::xml_translator_test {

using testing::ElementsAre;
using testing::HasSubstr;

// XML says by containerField where a node belongs, or leaves it to the kinds of nodes.
TEST(XmlTranslator, PutsNodesWhereTheyBelong) {
  EXPECT_EQ(
      difference_of(
          read_vrml97(
              "Collision { children [ DEF A Shape { geometry Sphere { } } USE A ] proxy Shape { geometry Box { } } }\n"
              "Sound { source MovieTexture { } }\nSwitch { choice [ Group { } Group { } ] whichChoice 0 }"),
          read_xml("<Collision><Shape DEF='A'><Sphere/></Shape><Shape containerField='proxy'><Box/></Shape><Shape "
                   "USE='A'/></Collision>"
                   "<Sound><MovieTexture/></Sound><Switch whichChoice='0'><Group/><Group/></Switch>")),
      "");
  EXPECT_THAT(error_of(read_xml("<Group><Shape containerField='proxy'/></Group>")),
              HasSubstr("Group has no field 'proxy'"));
  EXPECT_THAT(error_of(read_xml("<Shape><Box/>\n<Sphere/></Shape>")),
              HasSubstr("'geometry' is one node, and this is another"));
}

TEST(XmlTranslator, PutsInstancesWhereTheirFirstNodeBelongs) {
  EXPECT_EQ(
      difference_of(read_vrml97("Shape { appearance Appearance { } geometry Box { size 1 2 3 } }"),
                    read_xml("<ProtoDeclare name='A'><ProtoBody><Appearance/></ProtoBody></ProtoDeclare><ProtoDeclare "
                             "name='B'><ProtoBody>"
                             "<Box size='1 2 3'/></ProtoBody></ProtoDeclare><Shape><ProtoInstance "
                             "name='A'/><ProtoInstance name='B'/></Shape>")),
      "");
}

TEST(XmlTranslator, KeepsStatementsInTheirPlace) {
  const ReadResult result = read_xml(
      "<Group><Transform DEF='A'/><ROUTE fromNode='A' fromField='translation' toNode='A' toField='scale'/>"
      "<ProtoDeclare name='P'><ProtoBody><Group/></ProtoBody></ProtoDeclare><ProtoInstance name='P'/></Group>");
  EXPECT_EQ(
      difference_of(read_vrml97("Group { children [ DEF A Transform { } Group { } ] }\nROUTE A.translation TO A.scale"),
                    result),
      "");
}

TEST(XmlTranslator, TakesAnyName) {
  const ReadResult result = read_xml(
      "<Transform DEF='left.arm 1&amp;2'/><Group><Transform USE='left.arm 1&amp;2'/></Group>"
      "<ROUTE fromNode='left.arm 1&amp;2' fromField='translation' toNode='left.arm 1&amp;2' toField='scale'/>");
  ASSERT_TRUE(result.scene) << result.diagnostics.at(0).message;
  EXPECT_TRUE(result.scene->find("\"left.arm 1&2\""));
  EXPECT_THAT(routes_of(*result.scene->document), ElementsAre("left.arm 1&2.translation > left.arm 1&2.scale"));
}

TEST(XmlTranslator, ReadsTheSourceOfAScript) {
  EXPECT_EQ(difference_of(read_vrml97("Script { url [ \"a.js\" \"ecmascript: a = \\\"b\\\" < 'c\\\\n';\" ] }"),
                          read_xml("<Script url='\"a.js\"'><![CDATA[\n  ecmascript: a = \"b\" < 'c\\n';]]></Script>")),
            "");
}

TEST(XmlTranslator, GivesFieldsOfDeclarationsTheirTypesDefaults) {
  EXPECT_EQ(difference_of(
                read_vrml97("DEF S Script { field SFRotation r 0 0 1 0 field MFString s [ ] field SFNode n NULL field "
                            "SFTime t -1 eventIn SFBool b }"),
                read_xml("<Script DEF='S'><field accessType='initializeOnly' type='SFRotation' name='r'/><field "
                         "accessType='initializeOnly' "
                         "type='MFString' name='s'/><field accessType='initializeOnly' type='SFNode' name='n'/><field "
                         "accessType='initializeOnly' type='SFTime' name='t'/><field accessType='inputOnly' "
                         "type='SFBool' name='b'/></Script>")),
            "");
}

// Values cannot say more than their field.
TEST(XmlTranslator, NoValueBecomesANode) {
  const ReadResult result = read_xml("<Transform translation='0 0 0} Shape { geometry Box { }'/>");
  EXPECT_THAT(error_of(result), HasSubstr("'translation' (SFVec3f) wants numbers, found '0}'"));
}

TEST(XmlTranslator, NamesWhatItLeavesOut) {
  EXPECT_THAT(warnings_of(read_xml(
                  "<Group>\nhello</Group>\n<HAnimHumanoid><Transform DEF='lost'><Shape/></Transform></HAnimHumanoid>"
                  "<Group USE='lost'/>")),
              ElementsAre("a.x3d:1: text between tags is not read",
                          HasSubstr("a.x3d:3: HAnimHumanoid is a node of X3D that is not read")));
  EXPECT_THAT(error_of(read_xml("<ROUTE fromNode='A'/>")), HasSubstr("ROUTE wants the attribute"));
}

TEST(XmlTranslator, WrongFieldsAreNamedAtTheirLine) {
  const ReadResult result = read_xml("<Transform\n translaton='1 2 3'/>");
  EXPECT_EQ(error_of(result), "Transform has no field 'translaton', did you mean 'translation'?");
  EXPECT_EQ(result.diagnostics.at(0).where.line, 2U);
  EXPECT_EQ(result.diagnostics.at(0).where.column, 2U);
}

// ISO/IEC 19775-1 knows a DEF wherever it stands, also in a node that this reader leaves out.
TEST(XmlTranslator, KeepsNodesOfLeftOutNodesForAUse) {
  const ReadResult result = read_xml(
      "<WorldInfo><MetadataSet containerField='metadata'><Transform DEF='T' containerField='value'>"
      "<Shape DEF='S'><Box/></Shape></Transform></MetadataSet></WorldInfo>"
      "<Shape><Appearance><ComposedShader DEF='C'/><PixelTexture DEF='P' "
      "containerField='shaders'/></Appearance></Shape>"
      "<Transform USE='T'/><Group><Shape USE='S'/><Transform USE='T'/></Group>"
      "<Shape><Appearance><PixelTexture USE='P'/></Appearance></Shape>");
  EXPECT_EQ(difference_of(read_vrml97("WorldInfo { }\nShape { appearance Appearance { } }\n"
                                      "DEF T Transform { children DEF S Shape { geometry Box { } } }\n"
                                      "Group { children [ USE S USE T ] }\n"
                                      "Shape { appearance Appearance { texture DEF P PixelTexture { } } }"),
                          result),
            "");
}

TEST(XmlTranslator, NamesAUseOfWhatIsLeftOut) {
  const ReadResult result = read_xml(
      "<LayerSet><Layer DEF='L'/></LayerSet>\n<Layer USE='L'/><Layer USE='L'/>\n"
      "<Layer DEF='M'/>\n<Transform DEF='T'/><ROUTE fromNode='M' fromField='x' toNode='T' toField='translation'/>");
  EXPECT_THAT(warnings_of(result),
              testing::IsSupersetOf(
                  {HasSubstr("a.x3d:2: 'L' is a node that was left out"),
                   HasSubstr("a.x3d:4: 'M' is a node that was left out; a USE of it is empty, a ROUTE is left out")}));
  EXPECT_EQ(
      std::ranges::count_if(warnings_of(result), [](const std::string& w) { return w.contains("'L' is a node"); }), 1);
}

TEST(XmlTranslator, AUseCountsBeforeADef) {
  EXPECT_EQ(error_of(read_xml("<Shape DEF='A'/><Shape DEF='B' USE='A'/>")),
            "a node with USE is another one, and has no DEF of its own");
  EXPECT_EQ(difference_of(read_vrml97("DEF A Shape { }\nUSE A"), read_xml("<Shape DEF='A'/><Shape DEF='' USE='A'/>")),
            "");
  EXPECT_THAT(warnings_of(read_xml("<Shape DEF='A'/>\n<Shape USE='A'><Box/></Shape>")),
              ElementsAre("a.x3d:2: a node with USE is another one: what stands in it here is left out"));
  EXPECT_EQ(error_of(read_xml("<Shape USE=''/>")), "Shape wants the attribute 'USE'");
}

}  // namespace peerd::vrml::xml_translator_test
