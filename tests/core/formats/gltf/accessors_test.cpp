#include "core/formats/gltf/accessors.hpp"

#include <gmock/gmock.h>

#include "tests/core/formats/gltf/gltf_fixture.hpp"

namespace peerd::formats::gltf::accessors_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(GltfAccessors, SparseAndQuantisedValuesAreRead) {
  GltfMaker maker;
  const int dense =
      maker.accessor<std::int16_t>({0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0}, "VEC4", 5122, 3);  // padding is a fourth
  static_cast<void>(dense);
  const int view = maker.raw_view("{\"buffer\":0,\"byteLength\":24,\"byteStride\":8}");
  const int quantised = maker.raw_accessor("{\"bufferView\":" + std::to_string(view) +
                                           ",\"componentType\":5122,\"count\":3,\"type\":\"VEC3\"}");
  const auto shapes = shapes_of(read_file("a.gltf", maker.gltf(one_node(triangle_mesh(quantised, -1)) +
                                                               ",\"extensionsRequired\":[\"KHR_mesh_quantization\"]")));
  ASSERT_EQ(shapes.size(), 1U);
  EXPECT_EQ(shapes[0].points, (std::vector<Vec3>{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}));

  GltfMaker sparse;
  const int places = sparse.indices({1, 2});
  const int values = sparse.points({3, 0, 0, 0, 3, 0});
  const int zeros = sparse.raw_accessor(
      "{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"sparse\":{\"count\":2,\"indices\":{\"bufferView\":" +
      std::to_string(places) + ",\"componentType\":5123},\"values\":{\"bufferView\":" + std::to_string(values) + "}}}");
  const auto filled = shapes_of(read_file("a.gltf", sparse.gltf(one_node(triangle_mesh(zeros, -1)))));
  ASSERT_EQ(filled.size(), 1U);
  EXPECT_EQ(filled[0].points, (std::vector<Vec3>{{0, 0, 0}, {3, 0, 0}, {0, 3, 0}}));
}

TEST(GltfAccessors, IndicesOutOfRangeAreOneSentence) {
  GltfMaker maker;
  const int points = maker.points(kSquare), indices = maker.indices({0, 1, 4});
  EXPECT_EQ(error_of(read_file("a.gltf", maker.gltf(one_node(triangle_mesh(points, indices))))),
            "meshes/0/primitives/0: accessors/1: index 4 is out of range: there are 4 points");
}

TEST(GltfAccessors, TheyHaveTogetherNoMoreValuesThanTheFileAllows) {
  // Each mesh has its own zeros, and two are fewer than a file of any size may have.
  const auto read = [](int meshes, std::uint32_t expansion) {
    GltfMaker maker;
    std::string list, nodes;
    for (int i = 0; i < meshes; ++i) {
      const int zeros = maker.raw_accessor("{\"componentType\":5126,\"count\":125000,\"type\":\"VEC3\"}");
      list += (i == 0 ? "" : ",") +
              ("{\"primitives\":[{\"mode\":0,\"attributes\":{\"POSITION\":" + std::to_string(zeros) + "}}]}");
      nodes += (i == 0 ? "" : ",") + ("{\"mesh\":" + std::to_string(i) + "}");
    }
    ReadOptions options;
    options.limits.expansion = expansion;
    return read_file("a.gltf", maker.gltf("\"meshes\":[" + list + "],\"nodes\":[" + nodes + "]"), {}, options);
  };
  EXPECT_TRUE(read(2, 1).scene);
  EXPECT_THAT(error_of(read(3, 1)), HasSubstr("accessors/2: with it there are more values than a file of this size"));
  EXPECT_TRUE(read(3, 2).scene);
}

TEST(GltfAccessors, AHugeCountIsOneSentence) {
  GltfMaker maker;
  const int huge = maker.raw_accessor("{\"componentType\":5126,\"count\":2147483647,\"type\":\"VEC3\"}");
  EXPECT_THAT(error_of(read_file("a.gltf", maker.gltf(one_node(triangle_mesh(huge, -1))))),
              HasSubstr("a file of this size"));
}

}  // namespace
}  // namespace peerd::formats::gltf::accessors_test
