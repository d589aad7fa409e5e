#include "peerd/view/frames/picture_input.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <expected>
#include <string>
#include <variant>

#include "tests/peerd/view/picture/picture_of_text.hpp"

namespace peerd::view::picture_input_test {

using peerd::testing_support::picture_of_text;
using peerd::testing_support::scene_of;
using testing::ElementsAre;
using testing::IsEmpty;

TEST(PictureInput, WhatTheWorldMovesIsWhereItIsThen) {
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

// A Coordinate that the world moves is where it is then, too.
TEST(PictureInput, SceneAtHasWhatFlexes) {
  const Scene scene = scene_of(R"(
DEF T TimeSensor { cycleInterval 10 loop TRUE }
DEF I CoordinateInterpolator { key [0 1] keyValue [0 0 0, 1 0 0, 0 1 0, 0 0 10, 1 0 10, 0 1 10] }
Shape { geometry IndexedFaceSet { coord DEF C Coordinate { point [0 0 0, 1 0 0, 0 1 0] } coordIndex [0 1 2] } }
ROUTE T.fraction_changed TO I.set_fraction
ROUTE I.value_changed TO C.set_point)");
  EXPECT_EQ(std::get<FaceSetGeometry>(scene_at(scene, -1.0).geometries[0]).points[0].z(), 0.0F);
  EXPECT_FLOAT_EQ(std::get<FaceSetGeometry>(scene_at(scene, 5.0).geometries[0]).points[0].z(), 5.0F);
  EXPECT_EQ(std::get<FaceSetGeometry>(scene.geometries[0]).points[0].z(), 0.0F) << "the scene itself stays";
}

TEST(PictureInput, ImagesAreThoseOfTheFilesAroundTheWorld) {
  const FileLoader files = [](std::string_view url, std::string_view base) -> std::expected<LoadedFile, std::string> {
    if (url == "a.png") return LoadedFile{"name", std::string(base) + " has it"};
    return std::unexpected("there is no such file");
  };
  const ImageLoader images = images_of(files, "dir/w.wrl");
  EXPECT_EQ(images("a.png").value(), "dir/w.wrl has it");
  EXPECT_EQ(images("b.png").error(), "there is no such file");
}

TEST(PictureInput, ImagesThatAWorldCarriesNeedNoFiles) {
  const ImageLoader images = images_of({}, {});
  EXPECT_EQ(images("data:image/png;base64,YWJj").value(), "abc");
  EXPECT_EQ(images("data:image/png;base64,Y*").error(), "its data: URL is no base64");
  EXPECT_FALSE(images("a.png"));
}

}  // namespace peerd::view::picture_input_test
