#include "peerd/view/picture/appearance.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/peerd/view/picture/picture_of_text.hpp"

namespace peerd::view::appearance_test {

using peerd::testing_support::picture_of_text;
using testing::IsEmpty;

// 1 x 1 pixels, grey with alpha.
const std::string kPng("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\10\4\0\0\0\xb5\x1c\x0c\x02", 33);

TEST(Appearance, TexturesComeWithTheirImages) {
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
  // The default of s runs along the longer side, from 0 to 1, and t to 1/2; then moved, then scaled.
  EXPECT_TRUE(g.texture_coordinates[static_cast<std::size_t>(corner - g.positions.begin())].isApprox(
      Eigen::Vector2f(2 * (1 + 1), 4 * 0.5F)));
}

// ISO/IEC 14772-1, 6.49: a texture coordinate is translated, moved by the center, turned, scaled, and moved back.
TEST(Appearance, TextureTransformsGoInTheirOrder) {
  const ScenePicture drawn = picture_of_text(R"(
Shape { appearance Appearance { texture PixelTexture { image 1 1 1 0 }
          textureTransform TextureTransform { center 0.5 0.5 rotation 1.5707963 scale 2 3 translation 0.25 0 } }
        geometry IndexedFaceSet { coord Coordinate { point [0 0 0, 2 0 0, 2 1 0, 0 1 0] } coordIndex [0 1 2 3]
          texCoord TextureCoordinate { point [0 0, 1 0, 1 0.5, 0 0.5] } } })");
  EXPECT_THAT(drawn.undrawn, IsEmpty());
  const DrawnGeometry& g = drawn.geometries.at(0);
  const auto corner = std::ranges::find(g.positions, Eigen::Vector3f(2, 1, 0));
  ASSERT_NE(corner, g.positions.end());
  const auto at = g.texture_coordinates[static_cast<std::size_t>(corner - g.positions.begin())];
  // (1, 0.5), (1.25, 0.5), (1.75, 1), (-1, 1.75), (-2, 5.25)
  EXPECT_TRUE(at.isApprox(Eigen::Vector2f(-2.5F, 4.75F), 1e-5F)) << at.transpose();
}

TEST(Appearance, ARouteIntoATextureTransformIsNamed) {
  const ScenePicture drawn = picture_of_text(R"(
DEF T TimeSensor { loop TRUE } DEF SPIN ScalarInterpolator { key [0 1] keyValue [0 1] }
Shape { appearance Appearance { texture PixelTexture { image 1 1 1 0 } textureTransform DEF X TextureTransform { } } geometry Box { } }
ROUTE T.fraction_changed TO SPIN.set_fraction ROUTE SPIN.value_changed TO X.rotation)");
  ASSERT_EQ(drawn.undrawn.size(), 1u);
  EXPECT_EQ(drawn.undrawn[0].path, "X");
  EXPECT_EQ(drawn.undrawn[0].why, "no ROUTE changes its rotation");
}

}  // namespace peerd::view::appearance_test
