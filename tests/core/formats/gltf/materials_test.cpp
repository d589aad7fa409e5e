#include "core/formats/gltf/materials.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/core/formats/gltf/gltf_fixture.hpp"

namespace peerd::formats::gltf::materials_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

TEST(GltfMaterials, MaterialsAndImagesGoWithTheScene) {
  GltfMaker maker;
  const int points = maker.points(kSquare);
  const int texture = maker.accessor<float>({0, 0, 1, 0, 1, 1, 0, 0.25F}, "VEC2", 5126, 4);
  const std::string png = "\x89PNG...";
  const std::string rest =
      one_node("\"meshes\":[{\"primitives\":[{\"mode\":5,\"attributes\":{\"POSITION\":" + std::to_string(points) +
               ",\"TEXCOORD_0\":" + std::to_string(texture) + "},\"material\":0}]}]") +
      ",\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0,0.21404114,0.5],\"baseColorTexture\":{"
      "\"index\":0}},"
      "\"alphaMode\":\"BLEND\",\"normalTexture\":{\"index\":0}}],\"textures\":[{\"source\":0}],\"images\":[{\"uri\":"
      "\"a.png\"}]";
  const ReadResult result = read_file("a.gltf", maker.gltf(rest), {{"a.png", png}});
  EXPECT_EQ(shapes_of(result).size(), 1U);
  const vrml::Document& document = *result.scene->document;
  EXPECT_THAT(vrml::floats_of(document, "Material", "diffuseColor"),
              ElementsAre(ElementsAre(1, 0, testing::FloatNear(0.5F, 1e-6F))));
  EXPECT_THAT(vrml::floats_of(document, "Material", "transparency"), ElementsAre(ElementsAre(0.5F)));
  EXPECT_THAT(vrml::floats_of(document, "TextureCoordinate", "point"),
              ElementsAre(ElementsAre(0, 1, 1, 1, 1, 0, 0, 0.75F)));
  const auto images = vrml::nodes_of_type(document, "ImageTexture");
  ASSERT_EQ(images.size(), 1U);
  EXPECT_EQ(bytes_of_data_url(vrml::value_of(document.nodes[images[0]], "url").as<std::string_view>()[0]), png);
  EXPECT_EQ(result.sources.size(), 2U);
  EXPECT_THAT(warnings_of(result),
              UnorderedElementsAre(HasSubstr("materials/0: these are not shown: normalTexture, baseColorFactor beside"),
                                   HasSubstr("materials/0: its metallicFactor is not 0")));
}

TEST(GltfMaterials, WhatCannotBeShownIsNamedOnce) {
  GltfMaker maker;
  const int points = maker.points(kTriangle);
  const int texture = maker.accessor<float>({0, 0, 1, 0, 1, 1}, "VEC2", 5126, 3);
  const std::string attributes =
      "{\"attributes\":{\"POSITION\":" + std::to_string(points) + ",\"TEXCOORD_0\":" + std::to_string(texture) + "}";
  const ReadResult result = read_file(
      "a.gltf",
      maker.gltf(one_node("\"meshes\":[{\"primitives\":[" + attributes + ",\"material\":0}," + attributes +
                          ",\"material\":1}," + attributes + ",\"material\":2}," + attributes + ",\"material\":3}]}]") +
                 ",\"materials\":[{\"pbrMetallicRoughness\":{\"metallicFactor\":0.5}},{},{\"pbrMetallicRoughness\":{"
                 "\"metallicFactor\":0}},{\"extensions\":{\"KHR_materials_unlit\":{}},\"pbrMetallicRoughness\":{"
                 "\"baseColorFactor\":[2,1,1,1],\"baseColorTexture\":{\"index\":0}}}],"
                 "\"textures\":[{\"source\":0,\"sampler\":0}],\"samplers\":[{\"magFilter\":9728}],\"images\":[{"
                 "\"uri\":\"a.png\"}]"),
      {{"a.png", "\x89PNG..."}});
  EXPECT_EQ(shapes_of(result).size(), 4U);
  EXPECT_THAT(warnings_of(result),
              UnorderedElementsAre(HasSubstr("materials/0 and one other place: its metallicFactor is not 0"),
                                   HasSubstr("meshes/0/primitives/0 and 2 other places: TEXCOORD_0 is not kept"),
                                   HasSubstr("materials/3: these are not shown: baseColorFactor beyond 0 to 1"),
                                   HasSubstr("textures/0: the filters of its sampler are not kept")));
}

TEST(GltfMaterials, AnImageOfManyMaterialsIsThereOnce) {
  GltfMaker maker;
  const int points = maker.points(kTriangle), image = maker.accessor<std::uint8_t>({1, 2, 3, 4}, "SCALAR", 5121, 4);
  const int texture = maker.accessor<float>({0, 0, 1, 0, 1, 1}, "VEC2", 5126, 3);
  std::string primitives, materials, textures, images;
  for (int i = 0; i < 20; ++i) {
    const std::string comma = i == 0 ? "" : ",", number = std::to_string(i);
    primitives += comma + "{\"attributes\":{\"POSITION\":" + std::to_string(points) +
                  ",\"TEXCOORD_0\":" + std::to_string(texture) + "},\"material\":" + number + "}";
    materials += comma + "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":" + number + "}}}";
    textures += comma + "{\"source\":" + number + (i < 5 ? ",\"sampler\":0}" : "}");
    images += comma + (i % 2 == 0 ? "{\"bufferView\":" + std::to_string(image) + ",\"mimeType\":\"image/png\"}"
                                  : "{\"uri\":\"" + std::string(i % 3 == 0 ? "" : "./") + "a.png\"}");
  }
  const ReadResult result = read_file(
      "a.gltf",
      maker.gltf(one_node("\"meshes\":[{\"primitives\":[" + primitives + "]}]") + ",\"materials\":[" + materials +
                 "],\"samplers\":[{\"wrapS\":33071}],\"textures\":[" + textures + "],\"images\":[" + images + "]"),
      {{"a.png", "\x89PNG..."}, {"./a.png", "\x89PNG..."}});
  ASSERT_TRUE(result.scene);
  EXPECT_EQ(vrml::nodes_of_type(*result.scene->document, "Appearance").size(), 20U);
  // One of the bufferView and one of each URL, each with and without a repeat along s.
  EXPECT_EQ(vrml::nodes_of_type(*result.scene->document, "ImageTexture").size(), 6U);
}

TEST(GltfMaterials, ImagesThatShareBytesCostNoMoreThanTheFileAllows) {
  GltfMaker maker;
  const int points = maker.points(kTriangle);
  const int texture = maker.accessor<float>({0, 0, 1, 0, 1, 1}, "VEC2", 5126, 3);
  static_cast<void>(maker.accessor(std::vector<std::uint8_t>(30'000), "SCALAR", 5121, 30'000));
  std::string primitives, materials, textures, images;
  for (int i = 0; i < 1000; ++i) {
    const std::string comma = i == 0 ? "" : ",", number = std::to_string(i);
    const int view = maker.raw_view("{\"buffer\":0,\"byteOffset\":60,\"byteLength\":30000}");
    primitives += comma + "{\"attributes\":{\"POSITION\":" + std::to_string(points) +
                  ",\"TEXCOORD_0\":" + std::to_string(texture) + "},\"material\":" + number + "}";
    materials += comma + "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":" + number + "}}}";
    textures += comma + "{\"source\":" + number + "}";
    images += comma + "{\"bufferView\":" + std::to_string(view) + ",\"mimeType\":\"image/png\"}";
  }
  const auto read = [&](std::uint32_t expansion) {
    ReadOptions options;
    options.limits.expansion = expansion;
    const ReadResult result =
        read_file("a.gltf",
                  maker.gltf(one_node("\"meshes\":[{\"primitives\":[" + primitives + "]}]") + ",\"materials\":[" +
                             materials + "],\"textures\":[" + textures + "],\"images\":[" + images + "]"),
                  {}, options);
    EXPECT_TRUE(result.scene);
    return warnings_of(result);
  };
  const std::string why =
      "more values than a file of this size may ask for; the option expansion allows more; it is not shown";
  EXPECT_THAT(read(1), testing::Contains(HasSubstr(why)));
  EXPECT_THAT(read(8), testing::Not(testing::Contains(HasSubstr(why))));
}

TEST(GltfMaterials, ColoursAreThoseOfAScreen) {
  for (int i = 0; i <= 1000; ++i) {
    const double light = i / 1000.0;
    const double share = light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055;
    EXPECT_FLOAT_EQ(screen_share(light), static_cast<float>(share)) << light;
  }
}

}  // namespace
}  // namespace peerd::formats::gltf::materials_test
