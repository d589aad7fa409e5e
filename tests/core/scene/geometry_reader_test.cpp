// These tests read geometry nodes by their fields (ISO/IEC 14772-1:1997, clause 6).
#include "core/scene/geometry_reader.hpp"

#include <gmock/gmock.h>

#include "core/geometry/tessellate.hpp"
#include "tests/core/read_text.hpp"

namespace peerd::geometry_reader_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Geometry geometry_of(const std::string& node) {
  const Scene scene = scene_of("Shape { geometry " + node + " }");
  const Geometry* const geometry = scene.geometry(ObjectId{0});
  if (geometry == nullptr) {
    ADD_FAILURE() << node;
    return NoSurface{};
  }
  return *geometry;  // its arrays keep the document
}
template <class T>
T read(const std::string& node) {
  return std::get<T>(geometry_of(node));
}

TEST(GeometryReader, ReadsFieldsAndDefaults) {
  EXPECT_THAT(read<BoxGeometry>("Box { }").size, ElementsAre(2, 2, 2));
  EXPECT_EQ(read<SphereGeometry>("Sphere { }").radius, 1);
  EXPECT_EQ(read<SphereGeometry>("Sphere { radius 0.5 }").radius, 0.5f);
  const auto cone = read<ConeGeometry>("Cone { bottomRadius 3 height 4 side FALSE }");
  EXPECT_EQ(cone.bottom_radius, 3);
  EXPECT_EQ(cone.height, 4);
  EXPECT_FALSE(cone.side);
  EXPECT_TRUE(cone.bottom);
  const auto cylinder = read<CylinderGeometry>("Cylinder { radius 3 height 4 top FALSE bottom FALSE }");
  EXPECT_EQ(cylinder.radius, 3);
  EXPECT_EQ(cylinder.height, 4);
  EXPECT_TRUE(cylinder.side);
  EXPECT_FALSE(cylinder.top);
  EXPECT_FALSE(cylinder.bottom);
  const auto grid = read<ElevationGridGeometry>(
      "ElevationGrid { xDimension 2 zDimension 3 xSpacing 4 zSpacing 5 height [ 1 2 3 4 5 6 ] ccw FALSE }");
  EXPECT_EQ(grid.x_dimension, 2);
  EXPECT_EQ(grid.z_dimension, 3);
  EXPECT_EQ(grid.x_spacing, 4);
  EXPECT_EQ(grid.z_spacing, 5);
  EXPECT_THAT(grid.height.span(), ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_FALSE(grid.ccw);
  const auto extrusion =
      read<ExtrusionGeometry>("Extrusion { spine [ 0 0 0, 1 2 3 ] scale [ 1 1, 2 2 ] endCap FALSE }");
  EXPECT_EQ(extrusion.cross_section.size(), 5u);
  EXPECT_EQ(extrusion.spine[1], Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(extrusion.scale.size(), 2u);
  EXPECT_EQ(extrusion.orientation.size(), 1u);
  EXPECT_TRUE(extrusion.begin_cap);
  EXPECT_FALSE(extrusion.end_cap);
}

TEST(GeometryReader, NamesWhatHasNoSurface) {
  for (const char* type : {"IndexedLineSet", "PointSet", "Text"}) {
    const Geometry geometry = geometry_of(std::string(type) + " { }");
    EXPECT_EQ(std::get<NoSurface>(geometry).type, type);
    EXPECT_EQ(build_mesh(geometry).polygon_count(), 0u);
  }
}

// 6.19, 6.9, ..: sizes are > 0. A square of a Box is warned of, what is turned inside out is refused.
TEST(GeometryReader, WarnsOfSizesOfZeroAndRefusesNegativeOnes) {
  for (const char* node : {"Box { size 1 % 1 }", "Sphere { radius % }", "Cone { height % }", "Cylinder { radius % }",
                           "ElevationGrid { xSpacing % }"}) {
    const auto with = [&](const std::string& value) {
      std::string body = std::string("Shape { geometry ") + node + " }";
      body.replace(body.find('%'), 1, value);
      return problems_of(body);
    };
    EXPECT_THAT(with("0"), ElementsAre(testing::AllOf(HasSubstr("warning"), HasSubstr("should be > 0, found '0'"))));
    EXPECT_THAT(with("-1"), ElementsAre(HasSubstr("must be > 0, found '-1'")));
    EXPECT_THAT(with("1"), IsEmpty());
  }
}

TEST(FaceSets, KeepPolygonsAsTheyAreWritten) {
  const Geometry geometry = geometry_of(R"(IndexedFaceSet {
    ccw FALSE convex FALSE
    coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0, 0.1 0.2 0.3 ] }
    coordIndex [ 0 1 2 3 -1, 4 4 4 -1, 0, 1, 4 ] })");
  const auto& faces = std::get<FaceSetGeometry>(geometry);
  EXPECT_FALSE(faces.ccw);
  EXPECT_FALSE(faces.convex);
  EXPECT_THAT(faces.corners.span(), ElementsAre(0, 1, 2, 3, -1, 4, 4, 4, -1, 0, 1, 4));
  const Mesh mesh = build_mesh(geometry);
  ASSERT_EQ(mesh.polygon_count(), 3u);
  EXPECT_THAT(mesh.polygon(0), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(mesh.polygon(1), ElementsAre(4, 4, 4));
  EXPECT_THAT(mesh.polygon(2), ElementsAre(0, 1, 4));
  EXPECT_EQ(mesh.vertices[4], Eigen::Vector3f(0.1f, 0.2f, 0.3f));
  EXPECT_FALSE(mesh.ccw);
}

TEST(FaceSets, WithoutPolygonsAreEmpty) {
  for (const char* empty : {"IndexedFaceSet { }", "IndexedFaceSet { coord Coordinate { } coordIndex [ ] }",
                            "IndexedFaceSet { coord NULL coordIndex [ -1 -1 ] }"}) {
    EXPECT_EQ(build_mesh(geometry_of(empty)).polygon_count(), 0u) << empty;
  }
}

TEST(FaceSets, ReportBadIndicesWhereTheyAre) {
  EXPECT_THAT(
      problems_of("Shape { geometry IndexedFaceSet {\n"
                  " coord Coordinate { point [ 0 0 0 1 0 0 1 1 0 ] }\n"
                  " coordIndex [ 0 1 3 -1 # a comment\n"
                  "  0 -2 2 -1\n"
                  "  0 1 -1 -1 0 1 ] } }"),
      ElementsAre(
          "4:19: coordIndex 3 is out of range: the Coordinate has points 0 to 2",
          "5:5: coordIndex -2 is out of range: the Coordinate has points 0 to 2",
          "warning 6:3: 2 polygons have fewer than 3 corners, this one first: kept and numbered, without area"));
  EXPECT_THAT(problems_of("Shape { geometry IndexedFaceSet { coordIndex 7 } }"),
              ElementsAre("warning 2:46: this IndexedFaceSet has no points for its coordIndex: it has no polygons"));
}

TEST(FaceSets, SayNothingTwiceOfABrokenCoordinate) {
  EXPECT_THAT(
      problems_of("Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 nan ] } coordIndex [ 0 1 2 ] } }"),
      ElementsAre("2:66: 'nan' is not a finite number"));
  EXPECT_THAT(problems_of("Shape { geometry IndexedFaceSet { coord Cordinate { } coordIndex [ 0 1 2 ] } }"),
              ElementsAre("2:41: unknown node type 'Cordinate', did you mean 'Coordinate'?"));
  EXPECT_THAT(
      problems_of("Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0 0 ] } coordIndex [ 0 1 2 ] } }")
          .size(),
      1u);
  EXPECT_THAT(
      problems_of(
          "PROTO P [ field SFNode c NULL ] { Shape { geometry IndexedFaceSet { coord IS c coordIndex [ 0 1 2 ] } } }\n"
          "P { c Coordinate { point [ 0 0 x ] } }")
          .size(),
      1u);
}

// Worlds made for browsers leave the heights to a Script, which does not run here: there is no surface then.
TEST(ElevationGrids, MayGetTheirHeightsByARoute) {  // 6.17
  const std::string script = "DEF S Script { eventOut MFFloat h }\n";
  const std::string grid = "Shape { geometry DEF G ElevationGrid { xDimension 3 zDimension 3 } }\n";
  const std::string scripts = "warning 2:1: Scripts are kept and not run; this is the first one";
  const std::string routed = script + grid + "ROUTE S.h TO G.set_height\n";
  EXPECT_THAT(
      problems_of(routed),
      ElementsAre(scripts,
                  "warning 3:18: this ElevationGrid has no heights until set_height brings them: it has no polygons"));
  const Scene scene = scene_of(routed + "Shape { geometry Box { } }");
  ASSERT_EQ(scene.geometries.size(), 2u);
  EXPECT_EQ(mesh_size(scene.geometries[0], {}).polygons, 0u);
  EXPECT_EQ(build_mesh(scene.geometries[0], {}).polygon_count(), 0u);
  const std::string error = "3:18: this ElevationGrid of 3 by 3 needs 9 heights, it has 0";
  EXPECT_THAT(problems_of(script + grid + "DEF H ElevationGrid { } ROUTE S.h TO H.set_height"),
              testing::Contains(error))
      << "another one gets them";
  EXPECT_THAT(
      problems_of(script + "Shape { geometry DEF G ElevationGrid { xDimension 3 zDimension 3\nheight [ 1 2 ] } }\n"
                           "ROUTE S.h TO G.set_height"),
      testing::Contains("4:8: this ElevationGrid of 3 by 3 needs 9 heights, it has 2"));
}

TEST(ElevationGrids, NeedTheirHeights) {  // 6.17
  EXPECT_THAT(problems_of("Shape { geometry ElevationGrid { xDimension 2 zDimension 2\n height [ 1 2 3 ] } }"),
              ElementsAre("3:9: this ElevationGrid of 2 by 2 needs 4 heights, it has 3"));
  EXPECT_THAT(problems_of("Shape { geometry ElevationGrid { xDimension 2 zDimension 2 } }"),
              ElementsAre("2:18: this ElevationGrid of 2 by 2 needs 4 heights, it has 0"));
  EXPECT_THAT(problems_of("Shape { geometry ElevationGrid { xDimension 1 zDimension 2\n height [ 1 2 3 ] } }"),
              ElementsAre("warning 3:9: 1 heights are more than this ElevationGrid needs; they are not used"));
  EXPECT_THAT(problems_of("Shape { geometry ElevationGrid { xDimension 2147483647 zDimension 2147483647 } }").size(),
              1u);
  EXPECT_THAT(problems_of("Shape { geometry ElevationGrid { xDimension -1 zDimension 2 height [ ] } }"),
              ElementsAre(HasSubstr("must be >= 0")));
  EXPECT_THAT(problems_of("Shape { geometry ElevationGrid { } }"), IsEmpty());
}

TEST(ElevationGrids, AndExtrusionsStayWithinBinary32) {
  EXPECT_THAT(
      problems_of("Shape { geometry ElevationGrid { xDimension 3 xSpacing 3e38 zDimension 1 height [ 0 0 0 ] } }"),
      ElementsAre("2:18: this ElevationGrid is larger than binary32 can say"));
  EXPECT_THAT(problems_of("Shape { geometry Extrusion { scale 1e30 1e30 crossSection [ 1e30 0, 0 1 ] } }"),
              ElementsAre("2:18: this Extrusion is larger than binary32 can say"));
}

TEST(GeometryReader, RefusesMorePolygonsThanTheLimit) {
  ReadOptions options;
  options.limits.polygons = 6;
  EXPECT_THAT(problems_of("Shape { geometry Box { } }", {}, options), IsEmpty());
  options.limits.polygons = 5;
  EXPECT_THAT(problems_of("Shape { geometry Box { } }", {}, options),
              ElementsAre("2:18: this Box has 6 polygons, more than the 5 that one geometry may have"));
}

// A cross-section of 1,025 points along a spine of 1,025 makes 2^20 polygons and two caps.
TEST(GeometryReader, RefusesMoreSweptPolygonsThanTheTextMayAskFor) {
  std::string square = "Shape { geometry Extrusion { crossSection [";
  for (int i = 0; i <= 1024; ++i) square += " " + std::to_string(i) + " " + std::to_string(i % 2);
  square += " ] spine [";
  for (int i = 0; i <= 1024; ++i) square += " 0 " + std::to_string(i) + " 0";
  square += " ] } }";
  EXPECT_THAT(problems_of(square), ElementsAre(testing::ContainsRegex(
                                       "this Extrusion has 1048578 polygons, with which Extrusions and ElevationGrids "
                                       "have more than the [0-9]* that [0-9]* bytes of text may ask for; the option "
                                       "expansion allows more")));
  ReadOptions options;
  options.limits.expansion = 4;
  EXPECT_THAT(problems_of(square, {}, options), IsEmpty());
  EXPECT_THAT(problems_of(square + "\n" + square, {}, options), ElementsAre(HasSubstr("3:18: this Extrusion has")))
      << "all of them count together";
}

TEST(Extrusions, NeedOneScaleAndOrientationOrOneEach) {  // 6.18
  const auto with = [](const std::string& fields) {
    return problems_of("Shape { geometry Extrusion { spine [ 0 0 0, 0 1 0, 0 2 0 ]\n" + fields + " } }");
  };
  EXPECT_THAT(with("scale [ 1 1 ] orientation [ 0 0 1 0 ]"), IsEmpty());
  EXPECT_THAT(with("scale [ 1 1, 1 1, 2 2 ] orientation [ 0 0 1 0, 0 0 1 1, 0 0 1 2 ]"), IsEmpty());
  EXPECT_THAT(with("scale [ 1 1, 1 1 ]"),
              ElementsAre("3:7: 'scale' has 2 values for 3 spine points: one is needed, or one for each"));
  EXPECT_THAT(with("orientation [ 0 0 1 0, 0 0 1 1 ] scale [ ]").size(), 2u);
  EXPECT_THAT(with("scale [ 1 1, 0 0, -1 1 ]"), testing::Each(HasSubstr("warning")));
}

}  // namespace peerd::geometry_reader_test
