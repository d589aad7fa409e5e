#include "core/formats/gltf/container.hpp"

#include <gmock/gmock.h>

#include "tests/core/formats/gltf/gltf_fixture.hpp"

namespace peerd::formats::gltf::container_test {
namespace {

using testing::HasSubstr;

TEST(GltfContainer, BuffersImagesAndExtrasAreTakenOut) {
  const std::string text =
      R"({"a":[1,{"extras":{"x":[1,"}"]},"b":2}],"buffers":[{"extras":1}],"c":{"buffers":[{}]},"images":[],"d":"extras"})";
  const auto checked = checked_json(text, 10000);
  ASSERT_TRUE(checked);
  EXPECT_EQ(checked->text,
            R"({"a":[1,{"extras":null,"b":2}],"buffers":null,"c":{"buffers":[{}]},"images":null,"d":"extras"})");
  EXPECT_EQ(checked->buffers, R"([{"extras":1}])");
  EXPECT_EQ(checked->images, "[]");
}

TEST(GltfContainer, SkinsAreTakenOutAndTargetsHaveANode) {  // as in files that the Khronos validator calls good
  const auto text_of = [](const std::string& text) {
    const auto checked = checked_json(text, 10000);
    return checked ? checked->text : checked.error();
  };
  EXPECT_EQ(text_of(R"({"skins":[{"joints":[0]}],"b":1})"), R"({"skins":null,"b":1})");
  const std::string begin = R"({"animations":[{"channels":[{"target":{)", end = R"(}}]}]})";
  EXPECT_EQ(text_of(begin + R"("path":"pointer")" + end), begin + R"("path":"pointer","node":-1)" + end);
  EXPECT_EQ(text_of(begin + " " + end), begin + R"( "node":-1)" + end);
  EXPECT_EQ(text_of(begin + R"("node":0)" + end), begin + R"("node":0)" + end);
  EXPECT_EQ(text_of(R"({"extras":{"target":{}}})"), R"({"extras":null})");
}

TEST(GltfContainer, ExtrasOfAnySizeCostNothingAndAreCounted) {
  std::string long_list = "[0";
  for (int i = 0; i < 100'000; ++i) long_list += ",0";
  const auto checked = checked_json("{\"extras\":" + long_list + "],\"nodes\":[{\"extras\":1}]}", 2000);
  ASSERT_TRUE(checked) << checked.error();
  EXPECT_EQ(checked->extras, 2U);
}

TEST(GltfContainer, ValuesOfAnotherKindAreNamedByTheirPaths) {
  const auto error_of = [](const std::string& text) {
    const auto checked = checked_json(text, 100'000);
    return checked ? "" : checked.error();
  };
  EXPECT_EQ(error_of(R"({"materials":[{},{"doubleSided":"yes"}]})"),
            "materials/1/doubleSided: it must be true or false");
  EXPECT_EQ(error_of(R"({"nodes":[{"translation":[1,null,3]}]})"), "nodes/0/translation/1: it must be a number");
  EXPECT_EQ(error_of(R"({"nodes":[{"translation":[1,2]}]})"), "nodes/0/translation: it must have 3 numbers");
  EXPECT_EQ(error_of(R"({"nodes":[{"scale": [ ]}]})"), "nodes/0/scale: it must have 3 numbers");
  EXPECT_EQ(error_of(R"({"scene":1.0})"), "scene: it must be a whole number from 0 to 2147483647");
  EXPECT_EQ(error_of(R"({"nodes":[{"mesh":-1}]})"), "nodes/0/mesh: it must be a whole number from 0 to 2147483647");
  EXPECT_EQ(error_of(R"({"meshes":[{"primitives":[{"attributes":{"_MINE":{}}}]}]})"),
            "meshes/0/primitives/0/attributes/_MINE: it must be a whole number from 0 to 2147483647");
  EXPECT_EQ(error_of(R"({"images":[{"uri":7}]})"), "images/0/uri: it must be a string");
  EXPECT_EQ(error_of(R"({"extensions":{"KHR_lights_punctual":{"lights":[{"range":"9"}]}}})"),
            "extensions/KHR_lights_punctual/lights/0/range: it must be a number");
  EXPECT_EQ(error_of(R"({"extensions":{"MY_own":{"mesh":"a","range":[]}},"extras":{"mesh":"a"},"mine":{}})"), "");
  EXPECT_EQ(error_of(R"({"nodes":[{"name":"extras"},{"mesh":-1}]})"),
            "nodes/1/mesh: it must be a whole number from 0 to 2147483647");
  EXPECT_EQ(error_of(R"({"nodes":[{"extras":1},{"mesh":-1}]})"),
            "nodes/1/mesh: it must be a whole number from 0 to 2147483647");
  EXPECT_EQ(error_of(R"({"extensions":{"KHR_lights_punctual":[]}})"),
            "extensions/KHR_lights_punctual: it must be an object");
  EXPECT_EQ(error_of(R"({"nodes":[{"extensions":[]}]})"), "nodes/0/extensions: it must be an object");
  for (const std::string sparse : {R"({"count":2147483648})", R"({"indices":{"byteOffset":2147483648}})",
                                   R"({"values":{"byteOffset":2147483648}})"}) {
    EXPECT_THAT(error_of(R"({"accessors":[{"sparse":)" + sparse + "}]}"),
                HasSubstr(": it must be a whole number from 0 to 2147483647"));
  }
  EXPECT_EQ(error_of(R"({"accessors":[{"byteOffset":2147483648,"count":2147483648}]})"), "");
  EXPECT_EQ(error_of(R"({"images":[{"extras":{"uri":7}}],"nodes":[ ],"scenes":[{"nodes":[0,1]}]})"), "");
}

TEST(GltfContainer, KeysThatAnAuthorMakesUpStandInQuotes) {
  EXPECT_EQ(checked_json(R"({"meshes":[{"primitives":[{"attributes":{"\u001b]0;x":"a"}}]}]})", 10000).error(),
            "meshes/0/primitives/0/attributes/'?]0;x': it must be a whole number from 0 to 2147483647");
}

TEST(GltfContainer, KeysAreKnownHoweverTheyAreWritten) {
  EXPECT_EQ(checked_json(R"({"nodes":[{"m\u0065sh":-1}]})", 10000).error(),
            "nodes/0/mesh: it must be a whole number from 0 to 2147483647");
  EXPECT_EQ(checked_json(R"({"n\u006fdes":[{"\u006desh":-1}]})", 10000).error(),
            "nodes/0/mesh: it must be a whole number from 0 to 2147483647");
  const auto checked = checked_json(R"({"\u0062uffers":[{}],"\u0065xtras":1,"a\"\\\/\n\u00e4":[]})", 10000);
  ASSERT_TRUE(checked) << checked.error();
  EXPECT_EQ(checked->buffers, "[{}]");
  EXPECT_EQ(checked->extras, 1U);
}

TEST(GltfContainer, JsonThatAsksForMuchIsRefused) {
  EXPECT_THAT(checked_json("[" + std::string(100, '[') + "]", 10000).error(), HasSubstr("nested more than 32"));
  EXPECT_THAT(checked_json("[{},{},{}]", 800).error(), HasSubstr("asks for more"));
  EXPECT_TRUE(checked_json("[{},{}]", 800));
  for (const char* const bad : {"{", "[}", "]", "\"a", "{\"a\\\"", "[1,{\"extras\":[2]"})
    EXPECT_FALSE(checked_json(bad, 10000)) << bad;
}

TEST(GltfContainer, ChunksAreTheirs) {
  GltfMaker maker;
  const int points = maker.points(kSquare);
  const std::string glb = maker.glb(one_node(triangle_mesh(points, -1)));
  const auto chunks = chunks_of(glb);
  ASSERT_TRUE(chunks);
  EXPECT_EQ(chunks->binary, maker.buffer());
  for (std::size_t cut = 4; cut < glb.size(); ++cut) EXPECT_FALSE(chunks_of(std::string_view(glb).substr(0, cut)));
  EXPECT_THAT(warnings_of(read_file("a.glb", glb + "ab")),
              testing::Contains(HasSubstr("the last 2 bytes of the file")));
}

}  // namespace
}  // namespace peerd::formats::gltf::container_test
