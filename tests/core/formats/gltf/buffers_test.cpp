#include "core/formats/gltf/buffers.hpp"

#include <gmock/gmock.h>

#include "tests/core/formats/gltf/gltf_fixture.hpp"

namespace peerd::formats::gltf::buffers_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(GltfBuffers, IsTheSameByDataUriByFileAndAsGlb) {
  GltfMaker maker;
  const int points = maker.points(kSquare), indices = maker.indices({0, 1, 2, 0, 2, 3});
  const std::string rest = one_node(triangle_mesh(points, indices));
  const ReadResult beside = read_file("a.gltf", maker.json(rest, "my%20a.bin"), {{"my%20a.bin", maker.buffer()}});
  for (const ReadResult& result :
       {read_file("a.gltf", maker.gltf(rest)), read_file("a.glb", maker.glb(rest)), beside}) {
    const auto shapes = shapes_of(result);
    ASSERT_EQ(shapes.size(), 1U);
    EXPECT_EQ(shapes[0].path, "only/0");
    EXPECT_THAT(shapes[0].polygons, ElementsAre(ElementsAre(0, 1, 2), ElementsAre(0, 2, 3)));
    EXPECT_EQ(shapes[0].points[3], Vec3(0, 1, 0));
    EXPECT_THAT(warnings_of(result), testing::IsEmpty());
  }
  EXPECT_EQ(beside.sources.size(), 2U);  // the buffer is a part of the world
  EXPECT_EQ(error_of(read_file("a.gltf", maker.json(rest, "my%20a.bin"))),
            "buffers/0: 'my%20a.bin': there is no such file");
}

TEST(GltfBuffers, OneWithoutBytesIsNamed) {
  const ReadResult result = read_file(
      "a.gltf",
      "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":1},{\"byteLength\":1,\"uri\":\"data:,%30\"}]}");
  EXPECT_TRUE(result.scene);
  EXPECT_THAT(warnings_of(result), testing::ElementsAre(testing::HasSubstr("buffers/0: it has no bytes")));
}

TEST(GltfBuffers, AUriStandsForNoOther) {
  GltfMaker maker;
  const int points = maker.points(kTriangle);
  std::string text = maker.gltf(one_node(triangle_mesh(points, -1)));
  const std::string begin = "\"buffers\":[{";
  const std::size_t at = text.find(begin);
  ASSERT_NE(at, std::string::npos);
  for (const std::string uri : {"taken-out:0", "t\\u0061ken-out:0"}) {
    std::string two = text;
    two.insert(two.find("}],", at) + 1, ",{\"byteLength\":1,\"uri\":\"" + uri + "\"}");
    EXPECT_EQ(error_of(read_file("a.gltf", two)), "buffers/1: 'taken-out:0': there is no such file") << uri;
  }
  text.insert(at + begin.size(), "\"data:mine\" : \"data:x\",");  // a key is no URI
  EXPECT_EQ(shapes_of(read_file("a.gltf", text)).size(), 1U);
}

}  // namespace
}  // namespace peerd::formats::gltf::buffers_test
