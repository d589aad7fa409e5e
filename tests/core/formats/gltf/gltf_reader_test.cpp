#include "core/formats/gltf/gltf_reader.hpp"

#include <gmock/gmock.h>

#include <numbers>

#include "tests/core/formats/gltf/gltf_fixture.hpp"

namespace peerd::formats::gltf::gltf_reader_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Gltf, PlacesAreThoseOfItsNodes) {
  GltfMaker maker;
  const int points = maker.points({1, 2, 3, 0, 0, 0, 0, 1, 0});
  const double h = std::sqrt(0.5);
  const std::string nodes =
      ",\"nodes\":[{\"name\":\"arm\",\"translation\":[10,0,0],\"rotation\":[0,0," + std::to_string(h) + "," +
      std::to_string(h) +
      "],\"scale\":[2,2,2],\"children\":[1,2]},{\"name\":\"hand\",\"mesh\":0},{\"name\":\"the other\",\"mesh\":0,"
      "\"matrix\":[1,0.5,0,0, 0,1,0,0, 0,0,-1,0, 4,5,6,1]}],\"scene\":0,\"scenes\":[{\"nodes\":[0]}]";
  const auto shapes = shapes_of(read_file("a.gltf", maker.gltf(triangle_mesh(points, -1) + nodes)));
  ASSERT_EQ(shapes.size(), 2U);
  EXPECT_EQ(shapes[0].path, "arm/hand/0");
  EXPECT_LT((shapes[0].points[0] - Vec3(10 - 4, 2, 6)).norm(), 1e-5);
  // The matrix takes (1, 2, 3) to (5, 7.5, 3), and the arm turns it about z, doubles and shifts it.
  EXPECT_LT((shapes[1].points[0] - Vec3(10 - 15, 10, 6)).norm(), 1e-5);
}

TEST(Gltf, CamerasAndLightsAreNodesOfTheScene) {
  GltfMaker maker;
  const int points = maker.points(kTriangle);
  const ReadResult result = read_file(
      "a.gltf",
      maker.gltf(
          triangle_mesh(points, -1) +
          ",\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":0.5,\"znear\":0.1}},{\"type\":"
          "\"orthographic\",\"orthographic\":{\"xmag\":1,\"ymag\":1,\"zfar\":2,\"znear\":1}},{\"type\":\"perspective\","
          "\"perspective\":{\"yfov\":4,\"znear\":0.1}}],\"extras\":[1],"
          "\"extensionsUsed\":[\"KHR_lights_punctual\",\"KHR_physics\"],\"extensions\":{\"KHR_lights_punctual\":{"
          "\"lights\":[{\"type\":"
          "\"spot\",\"color\":[1,0,0],\"intensity\":1,\"spot\":{}}]}},\"nodes\":[{\"name\":\"cam\",\"camera\":0},{"
          "\"camera\":1},{\"camera\":2},"
          "{\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}},{\"mesh\":0}],\"scenes\":[{\"nodes\":[0,1,2,3,4]}"
          "]"));
  EXPECT_EQ(shapes_of(result).size(), 1U);
  const vrml::Document& document = *result.scene->document;
  EXPECT_THAT(vrml::floats_of(document, "Viewpoint", "fieldOfView"), ElementsAre(ElementsAre(0.5F)));
  EXPECT_THAT(vrml::floats_of(document, "SpotLight", "color"), ElementsAre(ElementsAre(1, 0, 0)));
  EXPECT_THAT(warnings_of(result),
              testing::UnorderedElementsAre(HasSubstr("a.gltf: the extension 'KHR_physics' is not read"),
                                            HasSubstr("nodes/1: its camera is no Viewpoint: only perspective"),
                                            HasSubstr("nodes/2: its camera is no Viewpoint: its yfov"),
                                            HasSubstr("cameras/0: of its perspective only yfov is kept"),
                                            HasSubstr("its extras are not kept: 1 of its parts")));
}

TEST(Gltf, ADirectionalLightStandsAtTheTopInItsDirection) {
  const ReadResult result = read_file(
      "a.gltf",
      "{\"asset\":{\"version\":\"2.0\"},\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"directional\"}"
      "]}},"
      "\"nodes\":[{\"rotation\":[1,0,0,1],\"children\":[1]},{\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}],"
      "\"scenes\":[{\"nodes\":[0]}]}");
  ASSERT_TRUE(result.scene);
  EXPECT_EQ(result.scene->document->top_level.size(), 2U);
  EXPECT_THAT(vrml::floats_of(*result.scene->document, "DirectionalLight", "direction"),
              ElementsAre(ElementsAre(0, 1, testing::FloatNear(0, 1e-6F))));
}

TEST(Gltf, ADirectionalLightHasADirectionOfLengthOneOrIsNamed) {
  const auto read = [](const char* scale) {
    return read_file("a.gltf",
                     "{\"asset\":{\"version\":\"2.0\"},\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":"
                     "\"directional\"}]}},\"nodes\":[{\"scale\":[1,1," +
                         std::string(scale) + "],\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}]}");
  };
  EXPECT_THAT(vrml::floats_of(*read("1e30").scene->document, "DirectionalLight", "direction"),
              ElementsAre(ElementsAre(0, 0, -1)));
  const ReadResult none = read("0");
  EXPECT_TRUE(vrml::nodes_of_type(*none.scene->document, "DirectionalLight").empty());
  EXPECT_THAT(warnings_of(none), ElementsAre(HasSubstr("nodes/0: its directional light has no direction")));
}

TEST(Gltf, ConesOfLightsAreThoseOfVrml) {
  const auto cones = [](const char* angles) {
    const ReadResult result = read_file(
        "a.gltf",
        "{\"asset\":{\"version\":\"2.0\"},\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":"
        "\"spot\",\"spot\":{" +
            std::string(angles) + "}}]}},\"nodes\":[{\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}]}");
    const vrml::Document& document = *result.scene->document;
    return std::tuple(vrml::floats_of(document, "SpotLight", "cutOffAngle").at(0).at(0),
                      vrml::floats_of(document, "SpotLight", "beamWidth").at(0).at(0), warnings_of(result).size());
  };
  constexpr float kHalfPi = 1.5707964F;
  EXPECT_EQ(cones("\"outerConeAngle\":0.5,\"innerConeAngle\":0.5"), std::tuple(0.5F, 0.5F, 0U));
  EXPECT_EQ(cones("\"outerConeAngle\":1.5707963705062866"), std::tuple(kHalfPi, 0.001F, 0U));
  EXPECT_EQ(cones("\"outerConeAngle\":2"), std::tuple(kHalfPi, 0.001F, 1U));
}

TEST(Gltf, ADirectionalLightThatAnAnimationWouldTurnIsNamed) {
  GltfMaker maker;
  const int times = maker.accessor<float>({0, 1}, "SCALAR", 5126, 2);
  const int turns = maker.accessor<float>({0, 0, 0, 1, 1, 0, 0, 0}, "VEC4", 5126, 2);
  const auto read = [&](const char* path, int output) {
    return warnings_of(read_file(
        "a.gltf", maker.gltf("\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"directional\"}]}},"
                             "\"nodes\":[{\"children\":[1]},{\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}],"
                             "\"scenes\":[{\"nodes\":[0]}],\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{"
                             "\"node\":0,\"path\":\"" +
                             std::string(path) + "\"}}],\"samplers\":[{\"input\":" + std::to_string(times) +
                             ",\"output\":" + std::to_string(output) + "}]}]")));
  };
  EXPECT_THAT(read("rotation", turns), ElementsAre(HasSubstr("nodes/1: its directional light stays")));
  EXPECT_THAT(read("translation", maker.points({0, 0, 0, 1, 0, 0})), ElementsAre());
}

TEST(Gltf, UnitsAndAxesAreThoseOfATransformAroundIt) {
  GltfMaker maker;
  const int points = maker.points(kTriangle);
  ReadOptions options;
  options.conversion = {.metres_per_unit = 0.5, .z_up = true};
  const auto shapes = shapes_of(read_file("a.gltf", maker.gltf(one_node(triangle_mesh(points, -1))), {}, options));
  ASSERT_EQ(shapes.size(), 1U);
  EXPECT_LT((shapes[0].points[2] - Vec3(0.5, 0, -0.5)).norm(), 1e-6);
}

// Hostile files: one sentence each.
struct Bad {
  const char* name;
  std::string file;
  const char* why;
};
class BadGltf : public testing::TestWithParam<Bad> {};
TEST_P(BadGltf, IsOneSentence) {
  EXPECT_THAT(error_of(read_file("a.gltf", GetParam().file)), HasSubstr(GetParam().why));
}

std::string with_nodes(const std::string& nodes) {
  return "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[" + nodes + "],\"scenes\":[{\"nodes\":[0]}]}";
}
std::string with_light(const std::string& light) {
  return "{\"asset\":{\"version\":\"2.0\"},\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{" + light +
         "}]}},\"nodes\":[{\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}]}";
}
std::string with_accessor(const std::string& accessor, const std::string& view = "\"buffer\":0,\"byteLength\":12") {
  return "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":12,\"uri\":\"data:;base64,AAAAAAAAAAAAAAAA\"}],"
         "\"bufferViews\":[{" +
         view + "}],\"accessors\":[{\"type\":\"VEC3\"," + accessor + "}]," + one_node(triangle_mesh(0, -1)) + "}";
}
std::string repeated(const std::string& text, int times) {
  std::string out;
  for (int i = 0; i < times; ++i) out += text;
  return out;
}
std::string chain(int nodes) {
  std::string list;
  for (int i = 0; i + 1 < nodes; ++i) list += "{\"children\":[" + std::to_string(i + 1) + "]},";
  return with_nodes(list + "{}");
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadGltf,
    testing::Values(
        Bad{"NoJson", "{", "ends in the middle"}, Bad{"NoVersion", "{\"a\":1}", "asset"},
        Bad{"Version1", "{\"asset\":{\"version\":\"1.0\"}}", "'1.0'"},
        Bad{"TextureWithoutIndex",
            "{\"asset\":{\"version\":\"2.0\"},\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{}}}]}",
            "'index' property is missing"},
        Bad{"Nested", "{\"a\":" + std::string(100'000, '['), "nested more than 32"},
        Bad{"ManyNodes", with_nodes(repeated("{},", 100'000) + "{}"), "asks for more than a file of this size"},
        Bad{"ManyExtensions",
            "{\"asset\":{\"version\":\"2.0\"},\"extensions\":{\"x\":{\"y\":[" + repeated("[],", 500'000) + "0]}}}",
            "asks for more"},
        Bad{"Circle", with_nodes("{\"children\":[1]},{\"children\":[0]}"), "more than one parent"},
        Bad{"Self", with_nodes("{\"children\":[0]}"), "more than one parent"},
        Bad{"Deep", chain(1000), "nested more than"},
        Bad{"NoChild", with_nodes("{\"children\":[7]}"), "nodes/7: there is none"},
        Bad{"NoMesh", with_nodes("{\"mesh\":7}"), "meshes/7"},
        Bad{"Matrix", with_nodes("{\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,2]}"), "last row"},
        Bad{"NarrowCone", with_light("\"type\":\"spot\",\"spot\":{\"innerConeAngle\":1,\"outerConeAngle\":0.5}"),
            "the cone of its light"},
        Bad{"NoCone", with_light("\"type\":\"spot\",\"spot\":{\"innerConeAngle\":-1}"), "the cone of its light"},
        Bad{"HugeRange", with_light("\"type\":\"point\",\"range\":1e300"), "the range of its light"},
        Bad{"NoRange", with_light("\"type\":\"spot\",\"spot\":{},\"range\":-1"), "the range of its light"},
        Bad{"ShortMatrix", with_nodes("{\"matrix\":[1,0]}"), "must have 16 numbers"},
        Bad{"HugeTranslation", with_nodes("{\"translation\":[1e300,0,0]}"), "binary32"},
        Bad{"Required", "{\"asset\":{\"version\":\"2.0\"},\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]}",
            "KHR_draco"},
        Bad{"ZerosWithoutEnd", with_accessor("\"componentType\":5126,\"count\":1000000000"), "more corners than"},
        Bad{"Beyond", with_accessor("\"bufferView\":0,\"componentType\":5126,\"count\":2"), "reach beyond"},
        Bad{"HugeOffset",
            with_accessor("\"bufferView\":0,\"byteOffset\":9000000000000000,\"componentType\":5126,\"count\":1"),
            "reach beyond"},
        Bad{"ViewBeyond",
            with_accessor("\"bufferView\":0,\"componentType\":5126,\"count\":1", "\"buffer\":0,\"byteLength\":13"),
            "beyond the bytes of its buffer"},
        Bad{"HugeView",
            with_accessor("\"bufferView\":0,\"componentType\":5126,\"count\":1",
                          "\"buffer\":0,\"byteOffset\":9007199254740991,\"byteLength\":12"),
            "beyond the bytes of its buffer"},
        Bad{"HugerView",
            with_accessor("\"bufferView\":0,\"componentType\":5126,\"count\":1",
                          "\"buffer\":0,\"byteOffset\":18446744073709551615,\"byteLength\":12"),
            "bufferViews/0/byteOffset: it must be a whole number"},
        Bad{"Negative", with_nodes("{\"skin\":-1}"), "nodes/0/skin: it must be a whole number"},
        Bad{"NoView", with_accessor("\"bufferView\":5,\"componentType\":5126,\"count\":1"), "no bufferView"},
        Bad{"Doubles", with_accessor("\"bufferView\":0,\"componentType\":5130,\"count\":1"), "componentType"},
        Bad{"BufferTooShort",
            "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":4000000000,\"uri\":\"data:;base64,AAAA\"}]}",
            "must have 4000000000 bytes"},
        Bad{"NoBase64",
            "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":1,\"uri\":\"data:;base64,A*\"}]}",
            "cannot be decoded"},
        Bad{"NoBytes",
            "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":12}],\"bufferViews\":[{\"buffer\":0,"
            "\"byteLength\":12}],"
            "\"accessors\":[{\"bufferView\":0,\"type\":\"VEC3\",\"componentType\":5126,\"count\":1}]," +
                one_node(triangle_mesh(0, -1)) + "}",
            "beyond the bytes of its buffer"},
        Bad{"GlbHeader", "glTF", "ends in its header"},
        Bad{"GlbChunk", std::string("glTF\2\0\0\0\x14\0\0\0\xff\xff\xff\xffJSON", 20), "ends behind the file"}),
    [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace peerd::formats::gltf::gltf_reader_test
