#include "core/formats/gltf/primitives.hpp"

#include <gmock/gmock.h>

#include "tests/core/formats/gltf/gltf_fixture.hpp"

namespace peerd::formats::gltf::primitives_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct Mode {
  int mode;
  std::vector<std::vector<std::int32_t>> polygons;
  std::size_t lines, points;
};
class GltfModes : public testing::TestWithParam<Mode> {};
TEST_P(GltfModes, GiveTheirElements) {
  GltfMaker maker;
  const int points = maker.points(kSquare);
  const ReadResult result = read_file(
      "a.gltf", maker.gltf(one_node(triangle_mesh(points, -1, ",\"mode\":" + std::to_string(GetParam().mode)))));
  const auto shapes = shapes_of(result);
  ASSERT_EQ(shapes.size(), 1U);
  EXPECT_EQ(shapes[0].polygons, GetParam().polygons);
  const vrml::Document& document = *result.scene->document;
  EXPECT_EQ(vrml::nodes_of_type(document, "IndexedLineSet").size(), GetParam().lines);
  EXPECT_EQ(vrml::nodes_of_type(document, "PointSet").size(), GetParam().points);
}
INSTANTIATE_TEST_SUITE_P(Table, GltfModes,
                         testing::Values(Mode{0, {}, 0, 1}, Mode{1, {}, 1, 0}, Mode{2, {}, 1, 0}, Mode{3, {}, 1, 0},
                                         Mode{4, {{0, 1, 2}}, 0, 0}, Mode{5, {{0, 1, 2}, {1, 3, 2}}, 0, 0},
                                         Mode{6, {{1, 2, 0}, {2, 3, 0}}, 0, 0}));

TEST(GltfPrimitives, MeshesAndAccessorsThatAreUsedTwiceAreThereOnce) {
  GltfMaker maker;
  const int points = maker.points(kSquare), indices = maker.indices({0, 1, 2});
  const ReadResult result = read_file(
      "a.gltf",
      maker.gltf("\"materials\":[{},{\"doubleSided\":true}]," +
                 triangle_mesh(points, indices,
                               ",\"material\":0},{\"attributes\":{\"POSITION\":0},\"indices\":1,\"material\":1") +
                 ",\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"translation\":[5,0,0]}],\"scenes\":[{\"nodes\":[0,1]}]"));
  EXPECT_EQ(shapes_of(result).size(), 4U);
  EXPECT_EQ(vrml::nodes_of_type(*result.scene->document, "IndexedFaceSet").size(), 2U);
  EXPECT_EQ(vrml::nodes_of_type(*result.scene->document, "Coordinate").size(), 1U);
}

TEST(GltfPrimitives, AttributesWithoutAUseAreNamedOnce) {
  GltfMaker maker;
  const int points = maker.points(kTriangle);
  const std::string at = std::to_string(points);
  const std::string both = "{\"attributes\":{\"POSITION\":" + at + ",\"NORMAL\":" + at + ",\"TANGENT\":" + at +
                           ",\"TEXCOORD_1\":" + at + ",\"_MINE\":" + at + "}";
  const ReadResult result = read_file(
      "a.gltf", maker.gltf(one_node("\"meshes\":[{\"primitives\":[" + both + "}," + both + ",\"mode\":0}]}]")));
  EXPECT_EQ(shapes_of(result).size(), 2U);
  EXPECT_THAT(warnings_of(result), testing::UnorderedElementsAre(
                                       HasSubstr("meshes/0/primitives/0 and one other place: 'TANGENT' is not kept"),
                                       HasSubstr("meshes/0/primitives/0 and one other place: 'TEXCOORD_1' is not kept"),
                                       HasSubstr("meshes/0/primitives/1: 'NORMAL' is not kept"),
                                       HasSubstr("meshes/0/primitives/0: these are not kept: _MINE"),
                                       HasSubstr("meshes/0/primitives/1: these are not kept: _MINE")));
}

TEST(GltfPrimitives, ColorsBesideAnImageAreNamed) {
  GltfMaker maker;
  const int points = maker.points(kTriangle), texture = maker.accessor<float>({0, 0, 1, 0, 1, 1}, "VEC2", 5126, 3);
  const ReadResult result = read_file(
      "a.gltf",
      maker.gltf(
          one_node("\"meshes\":[{\"primitives\":[{\"material\":0,\"attributes\":{\"POSITION\":0,\"COLOR_0\":" +
                   std::to_string(points) + ",\"TEXCOORD_0\":" + std::to_string(texture) + "}}]}]") +
          ",\"materials\":[{\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"baseColorTexture\":{\"index\":0}}}],"
          "\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"a.png\"}]"),
      {{"a.png", "\x89PNG..."}});
  EXPECT_EQ(shapes_of(result).size(), 1U);
  EXPECT_THAT(warnings_of(result), ElementsAre(HasSubstr("these are not kept: COLOR_0 beside the image")));
}

TEST(GltfPrimitives, ColoursBeyondTheScreensAreNamed) {
  GltfMaker maker;
  const int points = maker.points(kTriangle), colors = maker.points({1, 1, 1, 0, 0, 0, 2, 1, 1});
  const ReadResult result = read_file(
      "a.gltf", maker.gltf(one_node("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":" +
                                    std::to_string(points) + ",\"COLOR_0\":" + std::to_string(colors) + "}}]}]")));
  EXPECT_THAT(warnings_of(result),
              ElementsAre(HasSubstr("accessors/1: colours of COLOR_0 outside of 0 to 1 are clamped")));
}

TEST(GltfPrimitives, PrimitivesOfManyCombinationsCostNoMoreThanTheFileAllows) {
  GltfMaker maker;
  const int points = maker.points(std::vector<float>(3 * 3000, 0.0F));
  std::vector<int> accessors{points};
  for (int i = 1; i < 30; ++i) {
    accessors.push_back(
        maker.raw_accessor("{\"bufferView\":0,\"componentType\":5126,\"count\":3000,\"type\":\"VEC3\"}"));
  }
  std::string primitives;
  for (const int place : accessors) {
    for (const int color : accessors) {
      primitives += (primitives.empty() ? "" : ",") + ("{\"attributes\":{\"POSITION\":" + std::to_string(place) +
                                                       ",\"COLOR_0\":" + std::to_string(color) + "}}");
    }
  }
  EXPECT_THAT(error_of(read_file("a.gltf", maker.gltf(one_node("\"meshes\":[{\"primitives\":[" + primitives + "]}]")))),
              HasSubstr("more corners than"));
}

TEST(GltfPrimitives, NodesThatUseAMeshOfManyPrimitivesCostNoMoreThanTheFileAllows) {
  GltfMaker maker;
  const int points = maker.points(kTriangle);
  std::string primitives, nodes, roots;
  for (int i = 0; i < 2000; ++i) {
    const std::string comma = i == 0 ? "" : ",";
    primitives += comma + "{\"attributes\":{\"POSITION\":" + std::to_string(points) + "}}";
    nodes += comma + "{\"mesh\":0}";
    roots += comma + std::to_string(i);
  }
  EXPECT_THAT(error_of(read_file("a.gltf", maker.gltf("\"meshes\":[{\"primitives\":[" + primitives + "]}],\"nodes\":[" +
                                                      nodes + "],\"scenes\":[{\"nodes\":[" + roots + "]}]"))),
              HasSubstr("meshes/0: with this use of it the nodes use more primitives together than"));
}

}  // namespace
}  // namespace peerd::formats::gltf::primitives_test
