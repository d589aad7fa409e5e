#include "core/x3d/polygon_sets.hpp"

#include <gmock/gmock.h>

#include "tests/core/x3d/x3d_fixture.hpp"

namespace peerd::vrml::polygon_sets_test {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kPoints = "Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0, 5 0 0, 6 0 0, 5 1 0, 6 1 1 ] }";
constexpr const char* kPointsXml = "<Coordinate point='0 0 0, 1 0 0, 1 1 0, 0 1 0, 5 0 0, 6 0 0, 5 1 0, 6 1 1'/>";

// The polygons that each set has by ISO/IEC 19775-1, 11.4.
struct SetCase {
  const char* node;
  const char* field;   // may be empty
  const char* values;  // of the field
  const char* polygons;
};
class PolygonSet : public testing::TestWithParam<SetCase> {};

TEST_P(PolygonSet, IsTheFaceSetOfItsPolygons) {
  const auto& [node, field, values, polygons] = GetParam();
  const std::string expected = "Shape { geometry IndexedFaceSet { coord " + std::string(kPoints) + " coordIndex [ " +
                               polygons + " ] solid FALSE creaseAngle 3.1415927 } }";
  const std::string given = *field == '\0' ? "" : std::string(field) + " [ " + values + " ] ";
  const ReadResult vrml = read_vrml97(expected);
  EXPECT_EQ(difference_of(vrml, read_classic("Shape { geometry " + std::string(node) + " { " + given + "coord " +
                                             kPoints + " solid FALSE } }")),
            "");
  const std::string attribute = *field == '\0' ? "" : std::string(" ") + field + "='" + values + "'";
  EXPECT_EQ(difference_of(vrml, read_xml("<Shape><" + std::string(node) + attribute + " solid='false'>" + kPointsXml +
                                         "</" + node + "></Shape>")),
            "");
}
INSTANTIATE_TEST_SUITE_P(
    Table, PolygonSet,
    testing::Values(SetCase{"TriangleSet", "", "", "0 1 2 -1 3 4 5 -1"},
                    SetCase{"TriangleFanSet", "fanCount", "5 3", "0 1 2 -1 0 2 3 -1 0 3 4 -1 5 6 7 -1"},
                    SetCase{"TriangleStripSet", "stripCount", "5 3", "0 1 2 -1 2 1 3 -1 2 3 4 -1 5 6 7 -1"},
                    SetCase{"IndexedTriangleSet", "index", "0 1 2, 2 3 0", "0 1 2 -1 2 3 0 -1"},
                    SetCase{"IndexedTriangleFanSet", "index", "0 1 2 3 -1 4 5 6", "0 1 2 -1 0 2 3 -1 4 5 6 -1"},
                    SetCase{"IndexedTriangleStripSet", "index", "0 1 3 2 -1 4 5 6 7 -1",
                            "0 1 3 -1 3 1 2 -1 4 5 6 -1 6 5 7 -1"},
                    SetCase{"QuadSet", "", "", "0 1 2 3 -1 4 5 6 7 -1"},
                    SetCase{"IndexedQuadSet", "index", "3 2 1 0 4 5 7 6", "3 2 1 0 -1 4 5 7 6 -1"}),
    [](const auto& of) { return std::string(of.param.node); });

TEST(PolygonSets, KeepWhatAFaceSetHasToo) {
  EXPECT_EQ(
      difference_of(read_vrml97("Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0 1 0 0 0 1 0 ] } "
                                "coordIndex [ 0 1 2 -1 ] "
                                "color Color { color [ 1 0 0 ] } colorPerVertex FALSE normal Normal { vector [ 0 0 1 0 "
                                "0 1 0 0 1 ] } ccw FALSE } }"),
                    read_classic("PROTO P [ initializeOnly SFNode c NULL ] { Shape { geometry TriangleSet { coord IS c "
                                 "color Color { color [ 1 0 0 ] } "
                                 "colorPerVertex FALSE normal Normal { vector [ 0 0 1 0 0 1 0 0 1 ] } ccw FALSE } } }\n"
                                 "P { c Coordinate { point [ 0 0 0 1 0 0 0 1 0 ] } }")),
      "");
  EXPECT_EQ(difference_of(read_vrml97("Shape { geometry IndexedFaceSet { normalPerVertex FALSE } }"),
                          read_classic("Shape { geometry QuadSet { normalPerVertex FALSE } }")),
            "");
}

TEST(PolygonSets, RoutesLeadToTheFaceSet) {
  const ReadResult result = read_classic(
      "DEF Q QuadSet { }\nDEF F TriangleFanSet { }\nROUTE Q.coord TO F.coord\nROUTE F.fanCount TO F.fanCount");
  ASSERT_TRUE(result.scene);
  EXPECT_THAT(routes_of(*result.scene->document), ElementsAre("Q.coord > F.coord"));
  EXPECT_THAT(warnings_of(result),
              testing::Contains(HasSubstr("a.x3dv:5: 'fanCount' is a field of X3D that is not kept")));
}

TEST(PolygonSets, OpacityOfColorsIsNamed) {
  const ReadResult result = read_xml(
      "<Shape><PointSet><Coordinate point='0 0 0 1 1 1'/>\n<ColorRGBA color='1 0 0 1, 0 1 0 0.5'/></PointSet></Shape>");
  EXPECT_EQ(difference_of(read_vrml97("Shape { geometry PointSet { coord Coordinate { point [ 0 0 0 1 1 1 ] } color "
                                      "Color { color [ 1 0 0 0 1 0 ] } } }"),
                          result),
            "");
  EXPECT_THAT(warnings_of(result), ElementsAre("a.x3d:2: the opacity of the colors of this ColorRGBA is not kept"));
}

TEST(PolygonSets, CornersThatMakeNoPolygonAreNamed) {
  const std::string coord = std::string(" coord ") + kPoints + " } }";
  EXPECT_THAT(warnings_of(read_classic("Shape { geometry TriangleSet { " + coord)),
              ElementsAre("a.x3dv:2: 2 corners make no polygon; they are left out"));
  EXPECT_THAT(warnings_of(read_classic("Shape { geometry IndexedQuadSet { index [ 0 1 2 3 4 ]" + coord)),
              ElementsAre("a.x3dv:2: one corner makes no polygon; it is left out"));
  EXPECT_THAT(error_of(read_classic("Shape { geometry TriangleFanSet { fanCount [ 2 ]" + coord)),
              HasSubstr("at least three points, and not 2"));
  EXPECT_THAT(error_of(read_classic("Shape { geometry TriangleStripSet { stripCount [ 3 2000000000 ]" + coord)),
              HasSubstr("there are 8 points, fewer than"));
  const ReadResult outside = read_classic("Shape { geometry IndexedTriangleSet { index [ 0 1\n 8 ]" + coord);
  EXPECT_EQ(error_of(outside), "index has 8, but coord has 8 points, numbered from 0");
  EXPECT_EQ(outside.diagnostics.at(0).where.line, 3U);
  EXPECT_THAT(error_of(read_classic("Shape { geometry IndexedTriangleSet { index [ 0 1 -1 ]" + coord)),
              HasSubstr("index has -1"));
}

// Many short nodes share a long Coordinate: what they become is bounded by the size of the file.
TEST(PolygonSets, ShortTextsCannotAskForManyPolygons) {
  std::string body = "Shape { geometry PointSet { coord DEF C Coordinate { point [ ";
  for (int i = 0; i < 50000; ++i) body += "0 0 0 ";
  body += "] } } }\n";
  for (int i = 0; i < 300; ++i) {
    body += "Shape { geometry TriangleFanSet { fanCount " + std::to_string(50000 - i) + " coord USE C } }\n";
  }
  EXPECT_THAT(error_of(read_classic(body)), HasSubstr("more polygons than a file of this size may ask for"));
}

TEST(PolygonSets, WithoutPointsHaveNoPolygons) {
  const ReadResult result =
      read_classic("Shape { geometry IndexedTriangleSet { index [ 0 1 2 ]\ncoord CoordinateDouble { } } }");
  EXPECT_EQ(
      difference_of(read_vrml97("Shape { geometry IndexedFaceSet { coord NULL creaseAngle 3.1415927 } }"), result), "");
  EXPECT_THAT(warnings_of(result),
              testing::Contains("a.x3dv:2: this IndexedTriangleSet has no points: it has no polygons"));
}

}  // namespace peerd::vrml::polygon_sets_test
