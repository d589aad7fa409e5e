#include "core/x3d/head_statements.hpp"

#include <gmock/gmock.h>

#include "tests/core/x3d/x3d_fixture.hpp"

namespace peerd::vrml::head_statements_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(HeadStatements, SayTheUnits) {
  constexpr std::string_view kText =
      "PROFILE Interchange COMPONENT CADGeometry:2 META \"a\" \"b\" UNIT length mm 0.001 UNIT angle degree 0.0175 UNIT "
      "mass g 0.001 Group { }";
  Problems problems;
  TokenStream tokens(kText, problems.open({"a.x3dv", kText, nullptr}).value(), 0, problems);
  FileUnits units;
  int statements = 0;
  while (read_head_statement(tokens, units)) ++statements;
  EXPECT_EQ(statements, 6);
  EXPECT_EQ(units.length, 0.001);
  EXPECT_EQ(units.angle, 0.0175);
  EXPECT_TRUE(tokens.at_word("Group"));
  ASSERT_EQ(problems.take().diagnostics.size(), 1U) << "of the mass";
}

TEST(HeadStatements, ThatAreWrongAreNamed) {
  EXPECT_THAT(error_of(read_classic("UNIT length mm 0\n")), HasSubstr("the factor of a UNIT, a number > 0"));
  EXPECT_THAT(error_of(read_classic("UNIT mood bad 2\n")),
              HasSubstr("one of angle, force, length and mass, and not 'mood'"));
  const ReadResult meta = read_classic("META \"a\" b\nGroup { }");
  EXPECT_THAT(meta.diagnostics.at(0).message, HasSubstr("a string in quotes in META"));
}

// A Transform leads from the unit to metres, so that what ROUTEs bring is converted, too.
TEST(HeadStatements, UnitsConvertLengthsAndAngles) {
  const char* const expected =
      "WorldInfo { title \"t\" }\nTransform { scale 0.5 0.5 0.5 children [ "
      "Transform { rotation 0 0 1 1.5 translation 2 0 0 children Shape { geometry Box { size 3 3 3 } } }\n"
      "Shape { geometry Sphere { radius 2 } }\n"
      "OrientationInterpolator { key [ 0 1 ] keyValue [ 0 0 1 0, 0 0 1 3 ] }\nViewpoint { fieldOfView 1 position 0 0 "
      "20 } ] }";
  EXPECT_EQ(
      difference_of(
          read_vrml97(expected),
          read_classic(
              "UNIT length half 0.5 UNIT angle big 2\nWorldInfo { title \"t\" }\n"
              "Transform { rotation 0 0 1 0.75 translation 2 0 0 children Shape { geometry Box { size 3 3 3 } } }\n"
              "Shape { geometry Sphere { } }\n"
              "OrientationInterpolator { key [ 0 1 ] keyValue [ 0 0 1 0, 0 0 1 1.5 ] }\nViewpoint { fieldOfView 0.5 "
              "}")),
      "");
  const ReadResult xml =
      formats::read_file("a.x3d",
                         "<X3D><head><unit category='length' name='half' conversionFactor='0.5'/><unit "
                         "category='angle' name='b' conversionFactor='2'/></head>"
                         "<Scene><WorldInfo title='t'/><Transform rotation='0 0 1 0.75' translation='2 0 "
                         "0'><Shape><Box size='3 3 3'/></Shape></Transform>"
                         "<Shape><Sphere/></Shape><OrientationInterpolator key='0 1' keyValue='0 0 1 0 0 0 1 "
                         "1.5'/><Viewpoint fieldOfView='0.5'/></Scene></X3D>");
  EXPECT_EQ(difference_of(read_vrml97(expected), xml), "");
}

TEST(HeadStatements, UnitsOfFilesMeet) {
  const NamedFiles beside = {{"b.x3dv", "#X3D V3.3 utf8\nUNIT length four 4\nShape { geometry Box { size 1 1 1 } }"},
                             {"c.wrl", "#VRML V2.0 utf8\nShape { geometry Box { size 1 1 1 } }"}};
  const auto shapes =
      formats::shapes_of(read_classic("UNIT length half 0.5\nInline { url \"b.x3dv\" }\nInline { url \"c.wrl\" "
                                      "}\nShape { geometry Box { size 1 1 1 } }",
                                      beside));
  ASSERT_EQ(shapes.size(), 3U);
  const auto half = [](const formats::ReadShape& shape) { return shape.points.at(0).cwiseAbs().maxCoeff(); };
  EXPECT_EQ(half(shapes[0]), 2.0);
  EXPECT_EQ(half(shapes[1]), 0.5);
  EXPECT_EQ(half(shapes[2]), 0.25);
}

}  // namespace peerd::vrml::head_statements_test
