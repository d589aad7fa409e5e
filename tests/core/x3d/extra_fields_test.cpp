#include "core/x3d/extra_fields.hpp"

#include <gmock/gmock.h>

#include "core/vrml/node_types.hpp"
#include "tests/core/x3d/x3d_fixture.hpp"

namespace peerd::vrml::extra_fields_test {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(ExtraFields, AreThoseThatVrml97DoesNotHave) {
  EXPECT_EQ(find_extra_field("Box", "solid")->default_value, "TRUE");
  EXPECT_EQ(find_extra_field("Box", "size"), nullptr);
  EXPECT_EQ(find_extra_field("Sphere", "pauseTime"), nullptr);
  EXPECT_TRUE(find_extra_field("TimeSensor", "isPaused")->is_event());
  EXPECT_EQ(find_extra_field("AnyPrototype", "metadata")->type, "SFNode");
  EXPECT_TRUE(is_x3d_field_type("SFVec3d"));
  EXPECT_FALSE(is_x3d_field_type("SFVec3f"));
}

TEST(ExtraFields, WithTheirDefaultsAreNotNamed) {
  EXPECT_THAT(warnings_of(read_classic(
                  "Shape { visible TRUE bboxSize -1 -1.0 -1 geometry Box { solid TRUE metadata NULL } }\n"
                  "TimeSensor { pauseTime 0 description \"\" }\nNavigationInfo { transitionType [ \"LINEAR\" ] }\n"
                  "Shape { appearance Appearance { shaders [ ] lineProperties NULL } }")),
              IsEmpty());
  EXPECT_THAT(warnings_of(read_xml(
                  "<Shape visible='true' bboxSize='-1,-1 -1'><Box solid='true'/></Shape><TimeSensor pauseTime='0'/>")),
              IsEmpty());
}

TEST(ExtraFields, WithOtherValuesAreNamedByNodeFieldAndLine) {
  const std::vector<std::string> expected = {
      "2: 'visible' of Shape is a field of X3D that is not kept; its value has no effect",
      "3: 'solid' of Sphere is a field of X3D that is not kept; its value has no effect",
      "4: 'pauseTime' of TimeSensor is a field of X3D that is not kept; its value has no effect",
      "5: 'fillProperties' of Appearance is a field of X3D that is not kept; its value has no effect",
      "6: 'isPaused' of TimeSensor is a field of X3D that is not kept; the ROUTE is left out"};
  const auto of_file = [&](const std::string& name) {
    std::vector<std::string> lines;
    for (const std::string& line : expected) lines.push_back(name + ':' + line);
    return lines;
  };
  EXPECT_EQ(warnings_of(read_classic(
                "Shape { visible FALSE\n geometry Sphere { solid FALSE } }\nDEF T TimeSensor { pauseTime 4 }\n"
                "Shape { appearance Appearance { fillProperties DEF F FillProperties { } } }\nROUTE T.isPaused TO "
                "T.enabled")),
            of_file("a.x3dv"));
  EXPECT_EQ(warnings_of(read_xml(
                "\n<Shape visible='false'>\n<Sphere solid='false'/></Shape>\n<TimeSensor DEF='T' pauseTime='4'/>\n"
                "<Shape><Appearance><FillProperties/></Appearance></Shape>\n"
                "<ROUTE fromNode='T' fromField='isPaused' toNode='T' toField='enabled'/>")),
            of_file("a.x3d"));
}

TEST(ExtraFields, OfMetadataAreNamedOnceAFile) {
  EXPECT_THAT(
      warnings_of(read_xml(
          "<MetadataString name='a'/>\n<Group><MetadataSet/><MetadataInteger containerField='metadata'/></Group>")),
      ElementsAre("a.x3d:1: metadata is not kept, here and in the rest of this file"));
  // The default containerField of Metadata nodes is "value" in a MetadataSet, and "metadata" elsewhere.
  EXPECT_THAT(warnings_of(read_xml("<WorldInfo><MetadataSet><MetadataString/></MetadataSet></WorldInfo>\n"
                                   "<Shape><Box><MetadataString name='a'/></Box></Shape>")),
              ElementsAre("a.x3d:1: metadata is not kept, here and in the rest of this file"));
}

TEST(ExtraFields, OfAllPolygonSetsAreAttribAndFogCoord) {
  for (const std::string set : {"IndexedQuadSet", "IndexedTriangleFanSet", "IndexedTriangleSet", "QuadSet",
                                "IndexedTriangleStripSet", "TriangleFanSet", "TriangleSet", "TriangleStripSet"}) {
    EXPECT_THAT(
        warnings_of(read_xml("<Shape><" + set + "><FogCoordinate depth='1'/></" + set + "></Shape>")),
        ElementsAre("a.x3d:1: 'fogCoord' of " + set + " is a field of X3D that is not kept; its value has no effect"));
    ASSERT_NE(find_extra_field(set, "attrib"), nullptr);
  }
}

TEST(ExtraFields, ThatAreUsedAreNamedOnce) {
  EXPECT_THAT(
      warnings_of(read_classic("Shape { appearance DEF A Appearance { } }\n"
                               "Shape { appearance Appearance { shaders USE A material Material { } } }")),
      ElementsAre("a.x3dv:3: 'shaders' of Appearance is a field of X3D that is not kept; its value has no effect"));
}

// The field `level` of VRML97 is called `children`, and level_changed is no event of it.
TEST(ExtraFields, OfALodIsTheNumberOfItsLevel) {
  EXPECT_THAT(
      warnings_of(read_classic("DEF L LOD { }\nDEF S Switch { }\nROUTE L.level_changed TO S.whichChoice")),
      ElementsAre("a.x3dv:4: 'level_changed' of LOD is a field of X3D that is not kept; the ROUTE is left out"));
}

}  // namespace peerd::vrml::extra_fields_test
