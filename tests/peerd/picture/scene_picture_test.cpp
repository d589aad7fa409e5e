#include "peerd/picture/scene_picture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/peerd/picture/picture_of_text.hpp"

namespace peerd::picture::scene_picture_test {

using peerd::testing_support::picture_of_text;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> left_out(const ScenePicture& drawn) {
  std::vector<std::string> out;
  for (const Undrawn& u : drawn.undrawn) out.push_back(u.path + " " + u.what + ": " + u.why);
  return out;
}

// What is not drawn, or otherwise than the standard says, is named with its place.
TEST(ScenePicture, NamesWhatItLeavesOut) {
  struct Case {
    const char *name, *text, *line;
  };
  for (const Case& c : {
           Case{"Text", "DEF S Shape { geometry Text { string \"a\" } }", "S Text: no viewer draws it yet"},
           Case{"Billboard", "DEF B Billboard { children Shape { geometry Box { } } }",
                "B Billboard: it does not turn towards the viewer"},
           Case{"LOD", "DEF L LOD { range 5 level [ Shape { geometry Box { } } Shape { geometry Cone { } } ] }",
                "L LOD: its first level is drawn at any distance"},
           Case{"Anchor", "DEF A Anchor { url \"x\" children Shape { geometry Box { } } }",
                "A Anchor: its link is not followed"},
           Case{"Sensor", "DEF T Transform { children [ TouchSensor { } Shape { geometry Box { } } ] }",
                "T TouchSensor: no viewer works it"},
           Case{"Sound", "Sound { source AudioClip { url \"a.wav\" } }", " Sound: no viewer plays it"},
           Case{"Texture",
                "DEF S Shape { appearance Appearance { texture ImageTexture { url \"a.png\" } } geometry Box { } }",
                "S texture: ImageTexture: \"a.png\": it is not looked for"},
           Case{"Movie",
                "DEF S Shape { appearance Appearance { texture MovieTexture { url \"a.mpg\" } } geometry Box { } }",
                "S texture: MovieTexture"},
           Case{"Colours",
                "DEF S Shape { geometry IndexedFaceSet { coord Coordinate { point [0 0 0, 1 0 0, 0 1 0] } "
                "coordIndex [0 1 2] color Color { color [1 0 0, 0 1 0] } } }",
                "S IndexedFaceSet: its colours: they do not match its polygons"},
           Case{"Normals",
                "DEF S Shape { geometry IndexedFaceSet { coord Coordinate { point [0 0 0, 1 0 0, 0 1 0] } "
                "coordIndex [0 1 2] normal Normal { vector [0 0 0, 0 0 1, 0 0 1] } } }",
                "S IndexedFaceSet: its normals: they do not match its polygons"},
           Case{"Area",
                "DEF S Shape { geometry IndexedFaceSet { coord Coordinate { point [0 0 0, 1 0 0, 2 0 0] } "
                "coordIndex [0 1 2] } }",
                "S IndexedFaceSet: 1 polygon without area"},
           Case{"Route",
                "DEF T TimeSensor { loop TRUE } DEF I ColorInterpolator { key [0 1] keyValue [0 0 0, 1 1 1] } "
                "Shape { appearance Appearance { material DEF M Material { } } geometry Box { } } "
                "ROUTE T.fraction_changed TO I.set_fraction ROUTE I.value_changed TO M.set_diffuseColor",
                "M Material: no ROUTE changes its diffuseColor"},
           Case{"Scale",
                "DEF T TimeSensor { loop TRUE } DEF I PositionInterpolator { key [0 1] keyValue [1 1 1, 2 2 2] } "
                "DEF X Transform { children DEF S Shape { geometry Box { } } } "
                "ROUTE T.fraction_changed TO I.set_fraction ROUTE I.value_changed TO X.set_scale",
                "X/S Shape: it changes its shape as the world moves, and keeps that of the picture"},
           Case{"Light", "DEF G Group { children DirectionalLight { } }",
                "G DirectionalLight: it shines on everything, not only on its siblings"},
       }) {
    EXPECT_THAT(left_out(picture_of_text(c.text)), ElementsAre(c.line)) << c.name;
  }
}

TEST(ScenePicture, CountsWhatItLeavesOutBeyondAThousandOfAKind) {
  std::string text;
  for (int i = 0; i < 1500; ++i) text += "Shape { geometry Text { string \"" + std::to_string(i) + "\" } }\n";
  const ScenePicture drawn = picture_of_text(text);
  ASSERT_EQ(drawn.undrawn.size(), 1001u);
  EXPECT_EQ(drawn.undrawn.front().count, 1u);
  EXPECT_EQ(drawn.undrawn.back().count, 500u);
}

TEST(ScenePicture, DrawsWhatIsInTheWorld) {
  const ScenePicture drawn = picture_of_text(R"(
Switch { whichChoice 1 choice [ DEF A Shape { geometry Box { } } DEF B Shape { geometry Cone { } } ] }
Switch { choice DEF C Shape { geometry Box { } } }
Collision { proxy DEF D Shape { geometry Box { } } children DEF E Shape { geometry Sphere { } } })");
  EXPECT_THAT(drawn.shape_paths, ElementsAre("0/B", "2/E"));
  EXPECT_THAT(drawn.undrawn, IsEmpty());
}

TEST(ScenePicture, NormalsAreFlatUpToTheCreaseAngle) {
  const auto normals_with = [](const char* crease) {
    const ScenePicture drawn =
        picture_of_text(std::string("Shape { geometry IndexedFaceSet { creaseAngle ") + crease +
                        R"( coord Coordinate { point [0 0 0, 1 0 0, 1 1 0, 0 1 0, -1 0 -1, -1 1 -1] }
      coordIndex [0 1 2 3 -1 4 0 3 5 -1] } })");
    return drawn.geometries.at(0);
  };
  const DrawnGeometry flat = normals_with("0"), smooth = normals_with("1");  // the angle between the two is pi/4
  EXPECT_EQ(flat.positions.size(), 8u);
  for (const Eigen::Vector3f& n : flat.normals) {
    EXPECT_TRUE(n.isApprox(Eigen::Vector3f::UnitZ()) || n.isApprox(Eigen::Vector3f(-1, 0, 1).normalized()));
  }
  EXPECT_EQ(smooth.positions.size(), 6u) << "the edge is shared";
  const auto edge = std::ranges::find(smooth.positions, Eigen::Vector3f(0, 0, 0));
  ASSERT_NE(edge, smooth.positions.end());
  const Eigen::Vector3f between = (Eigen::Vector3f::UnitZ() + Eigen::Vector3f(-1, 0, 1).normalized()).normalized();
  EXPECT_TRUE(smooth.normals[static_cast<std::size_t>(edge - smooth.positions.begin())].isApprox(between, 1e-5F));
}

TEST(ScenePicture, RoundSolidsAreDrawnRound) {
  for (const char* form : {"Sphere { radius 2 }", "Cylinder { radius 2 top FALSE bottom FALSE }"}) {
    const ScenePicture drawn = picture_of_text("Shape { geometry " + std::string(form) + " }");
    const DrawnGeometry& g = drawn.geometries.at(0);
    for (std::size_t i = 0; i < g.positions.size(); ++i) {
      Eigen::Vector3f out = g.positions[i];
      if (form[0] == 'C') out.y() = 0;
      EXPECT_GT(g.normals[i].dot(out.normalized()), 0.99F) << form;
    }
  }
  const DrawnGeometry cylinder = picture_of_text("Shape { geometry Cylinder { } }").geometries.at(0);
  EXPECT_EQ(cylinder.positions.size(), 4u * 24) << "the caps have an edge";
}

TEST(ScenePicture, ColoursAreThoseOfVerticesOrFaces) {
  const std::string points =
      "coord Coordinate { point [0 0 0, 1 0 0, 1 1 0, 0 1 0] } coordIndex [0 1 2 -1 0 2 3 -1] "
      "color Color { color [1 0 0, 0 1 0, 0 0 1, 1 1 0] } ";
  const auto drawn = [&](const std::string& more) {
    return picture_of_text("Shape { geometry IndexedFaceSet { " + points + more + " } }").geometries.at(0);
  };
  const auto color_at = [](const DrawnGeometry& g, std::size_t corner) { return g.colors.at(g.corners.at(corner)); };
  const DrawnGeometry by_vertex = drawn("");
  EXPECT_EQ(color_at(by_vertex, 2), (Color{0, 0, 1}));
  EXPECT_EQ(color_at(by_vertex, 5), (Color{1, 1, 0}));
  const DrawnGeometry by_index = drawn("colorIndex [3 2 1 -1 0 0 0 -1]");
  EXPECT_EQ(color_at(by_index, 0), (Color{1, 1, 0}));
  EXPECT_EQ(color_at(by_index, 4), (Color{1, 0, 0}));
  const DrawnGeometry by_face = drawn("colorPerVertex FALSE");
  for (const std::size_t corner : {0, 1, 2}) EXPECT_EQ(color_at(by_face, corner), (Color{1, 0, 0}));
  for (const std::size_t corner : {3, 4, 5}) EXPECT_EQ(color_at(by_face, corner), (Color{0, 1, 0}));
  const DrawnGeometry by_face_index = drawn("colorPerVertex FALSE colorIndex [2 3]");
  EXPECT_EQ(color_at(by_face_index, 0), (Color{0, 0, 1}));
  EXPECT_EQ(color_at(by_face_index, 3), (Color{1, 1, 0}));
}

TEST(ScenePicture, LinesAndPointsShineByThemselves) {
  const ScenePicture drawn = picture_of_text(R"(
Shape { appearance Appearance { material Material { emissiveColor 1 0 0 } }
        geometry IndexedLineSet { coord Coordinate { point [0 0 0, 1 0 0, 1 1 0] } coordIndex [0 1 2 -1 2 0 -1] } }
Shape { geometry PointSet { coord Coordinate { point [0 0 0, 1 0 0] } color Color { color [1 0 0, 0 1 0] } } })");
  ASSERT_EQ(drawn.geometries.size(), 2u);
  EXPECT_EQ(drawn.geometries[0].mode, DrawnGeometry::Mode::kLines);
  EXPECT_EQ(drawn.geometries[0].corners.size(), 2u * 3);
  EXPECT_EQ(drawn.geometries[1].mode, DrawnGeometry::Mode::kPoints);
  EXPECT_THAT(drawn.geometries[1].colors, ElementsAre(Color{1, 0, 0}, Color{0, 1, 0}));
  const DrawnMaterial& lines = drawn.materials[drawn.meshes[drawn.shapes[0].mesh].material];
  EXPECT_FALSE(lines.lit);
  EXPECT_EQ(lines.diffuse, (Color{1, 0, 0}));
}

// 1 x 1 pixels, grey with alpha.
const std::string kPng("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\10\4\0\0\0\xb5\x1c\x0c\x02", 33);

TEST(ScenePicture, TexturesComeWithTheirImages) {
  int read = 0;
  const ImageLoader images = [&](std::string_view url) -> std::expected<std::string, std::string> {
    ++read;
    if (url != "there.png") return std::unexpected("there is no such file");
    return kPng;
  };
  const ScenePicture drawn = picture_of_text(R"(
Shape { appearance Appearance { texture ImageTexture { url ["away.png" "there.png"] repeatS FALSE } material Material { diffuseColor 1 0 0 transparency 0.5 }
                                textureTransform TextureTransform { scale 2 4 translation 1 0 } }
        geometry IndexedFaceSet { coord Coordinate { point [0 0 0, 2 0 0, 2 1 0, 0 1 0] } coordIndex [0 1 2 3] } }
Shape { appearance Appearance { texture ImageTexture { url "there.png" } } geometry Box { } })",
                                             0.0, images);
  EXPECT_THAT(drawn.undrawn, IsEmpty());
  EXPECT_EQ(drawn.images.size(), 1u);
  EXPECT_EQ(read, 2) << "each URL once";
  const DrawnMaterial& material = drawn.materials[drawn.meshes[drawn.shapes[0].mesh].material];
  ASSERT_TRUE(material.texture);
  EXPECT_FALSE(material.texture->repeat_s);
  EXPECT_TRUE(material.texture->repeat_t);
  EXPECT_EQ(material.diffuse, (Color{1, 0, 0})) << "a grey texture shades the colour";
  EXPECT_EQ(material.transparency, 0.0F) << "the image has its own";
  const DrawnGeometry& g = drawn.geometries[drawn.meshes[drawn.shapes[0].mesh].geometry];
  const auto corner = std::ranges::find(g.positions, Eigen::Vector3f(2, 1, 0));
  ASSERT_NE(corner, g.positions.end());
  // By default s runs along the longer side, from 0 to 1, and t to 1/2; then moved, then scaled.
  EXPECT_TRUE(g.texture_coordinates[static_cast<std::size_t>(corner - g.positions.begin())].isApprox(
      Eigen::Vector2f(2 * (1 + 1), 4 * 0.5F)));
}

TEST(ScenePicture, WhatTheWorldMovesIsWhereItIsThen) {
  const std::string text = R"(
DEF T TimeSensor { cycleInterval 10 loop TRUE }
DEF I PositionInterpolator { key [0 1] keyValue [0 0 0, 10 0 0] }
DEF MILL Transform { children Shape { geometry Box { } } }
ROUTE T.fraction_changed TO I.set_fraction
ROUTE I.value_changed TO MILL.set_translation
DEF DRIFT Transform { velocityVector 0 2 0 children Shape { geometry Box { } } })";
  const ScenePicture drawn = picture_of_text(text, 3.0);
  ASSERT_THAT(drawn.node_paths, ElementsAre("MILL", "DRIFT", ""));
  EXPECT_NEAR(drawn.nodes[0].pose.position.x(), 3.0, 1e-6);
  EXPECT_NEAR(drawn.nodes[1].pose.position.y(), 6.0, 1e-6);
  EXPECT_THAT(drawn.undrawn, IsEmpty());
}

}  // namespace peerd::picture::scene_picture_test
