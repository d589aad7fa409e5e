#include "core/x3d/xml_translator.hpp"

#include <gmock/gmock.h>

#include "tests/core/x3d/x3d_fixture.hpp"

namespace peerd::vrml::xml_translator_test {

using testing::ElementsAre;
using testing::HasSubstr;

// Where a node belongs, XML says by containerField or leaves to the kinds of nodes.
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

}  // namespace peerd::vrml::xml_translator_test
