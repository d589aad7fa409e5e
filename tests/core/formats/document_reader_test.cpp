#include "core/formats/document_reader.hpp"

#include <gmock/gmock.h>

#include <string>
#include <string_view>
#include <vector>

#include "tests/core/formats/format_fixture.hpp"

namespace peerd::formats::document_reader_test {
namespace {

using testing::HasSubstr;

TEST(DocumentReader, ReadsVrmlAsBefore) {
  EXPECT_EQ(shapes_of(read_file("a.wrl", "#VRML V2.0 utf8\nShape { geometry Box { } }")).size(), 1U);
  EXPECT_FALSE(read_file("a.wrl", "nothing of all").scene);
}

TEST(DocumentReader, AFileLargerThanTheLimitIsOneSentence) {
  ReadOptions options;
  options.limits.text_bytes = 10;
  EXPECT_THAT(error_of(read_file("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", {}, options)),
              HasSubstr("larger than 10 bytes"));
}

TEST(DocumentReader, WhatAProgramsReaderSaysHasNoPlaceInBytes) {
  const ReadResult result = read_file("a.glb", "glTF");
  EXPECT_EQ(render(result, result.diagnostics.at(0)), "a.glb: error: the GLB file ends in its header\n");
}

constexpr std::string_view kWorld = "#VRML V2.0 utf8\n";
constexpr const char* kObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\no left arm\nf 1 2 3\no hand\nf 1 2 3\n";

ReadResult read_vrml(const std::string& body, const NamedFiles& files) {
  return read_file("a.wrl", std::string(kWorld) + body, files);
}

TEST(DocumentReader, InlinesHoldFilesOfAnyFormat) {
  const ReadResult good = read_vrml(
      "DEF A Transform { translation 5 0 0 children Inline { url [ \"none.obj\" \"b.obj\" ] } }\nInline { url "
      "\"b.obj\" }\n"
      "DEF B Inline { url \"c.wrl\" }\nCollisionInterest { objectPath \"A/0/\\\"left arm\\\"\" interests \"B/1/hand\" "
      "}\n",
      {{"b.obj", kObj},
       {"c.wrl", std::string(kWorld) + "Inline { url \"t.off\" } Inline { url \"b.obj\" }"},
       {"t.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"}});
  const auto shapes = shapes_of(good);
  std::vector<std::string> paths;
  for (const ReadShape& shape : shapes) paths.push_back(shape.path);
  EXPECT_THAT(paths, testing::ElementsAre("A/0/\"left arm\"/0", "A/0/hand/0", "1/\"left arm\"/0", "1/hand/0", "B/0/0/0",
                                          "B/1/\"left arm\"/0", "B/1/hand/0"));
  EXPECT_EQ(shapes.at(0).points.at(0), Vec3(5, 0, 0));
  EXPECT_EQ(good.scene->geometries.size(), 3U) << "a file that is there three times is read once";
  EXPECT_EQ(good.scene->interests.size(), 1U);
  EXPECT_EQ(good.sources.size(), 4U);
}

TEST(DocumentReader, WhatIsWrongInAnInlinedFileIsAnErrorThere) {
  const ReadResult result = read_vrml("Inline { url \"b.obj\" }\n", {{"b.obj", "v 0 0 0\nf 1 2 3\n"}});
  EXPECT_THAT(render(result, result.diagnostics.at(0)), HasSubstr("b.obj:2:1: error: '2' names no point"));
  EXPECT_FALSE(result.scene);
  EXPECT_THAT(warnings_of(read_vrml("EXTERNPROTO P [ ] \"b.obj\"\nP { }\n", {{"b.obj", kObj}})),
              testing::ElementsAre(HasSubstr("'b.obj': it is of a format that has no PROTOs")));
  ReadOptions options;
  options.limits.text_bytes = 60;
  const std::string body = std::string(kWorld) + "Inline { url \"b.obj\" }\n";
  EXPECT_THAT(error_of(read_file("a.wrl", body, {{"b.obj", std::string(1000, '#')}}, options)),
              HasSubstr("'b.obj' is larger than 20 bytes"));
}

TEST(DocumentReader, InlinedAnimationsRunByTheWorldAround) {
  const std::string gltf =
      "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"name\":\"arm\"}],\"buffers\":[{\"byteLength\":32,\"uri\":\"b."
      "bin\"}],"
      "\"bufferViews\":[{\"buffer\":0,\"byteLength\":8},{\"buffer\":0,\"byteOffset\":8,\"byteLength\":24}],"
      "\"accessors\":[{"
      "\"bufferView\":0,\"componentType\":5126,\"count\":2,\"type\":\"SCALAR\"},{\"bufferView\":1,\"componentType\":"
      "5126,"
      "\"count\":2,\"type\":\"VEC3\"}],\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":"
      "\"translation\"}}],\"samplers\":[{\"input\":0,\"output\":1}]}]}";
  std::string buffer;
  for (const float value : {0.0F, 2.0F, 0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F}) append(buffer, value);
  const NamedFiles files{{"b.gltf", gltf}, {"b.bin", buffer}};
  const ReadResult result = read_vrml("Group { }\nDEF I Inline { url \"b.gltf\" }\n", files);
  ASSERT_TRUE(result.scene);
  const vrml::Document& document = *result.scene->document;
  EXPECT_EQ(vrml::document_violation(document), "");
  ASSERT_EQ(document.routes.size(), 2U);
  EXPECT_EQ(document.nodes.at(document.routes[1].to_node).def, "arm");
  EXPECT_TRUE(vrml::nodes_of_type(document, "WorldInfo").empty());
  EXPECT_EQ(vrml::nodes_of_type(*read_file("b.gltf", gltf, files).scene->document, "WorldInfo").size(), 1U);
}

TEST(DocumentReader, InlinedFilesHaveTogetherNoMoreThanTheWorldAllows) {
  // Each file asks for a third of what files of any size together may ask for.
  const std::string gltf =
      "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"mode\":0,"
      "\"attributes\":{"
      "\"POSITION\":0}}]}],\"accessors\":[{\"componentType\":5126,\"count\":115000,\"type\":\"VEC3\"}]}";
  NamedFiles files;
  std::string body;
  for (int i = 0; i < 4; ++i) {
    const std::string name = std::to_string(i) + ".gltf";
    files.emplace(name, gltf);
    body += "Inline { url \"" + name + "\" }\n";
    EXPECT_EQ(read_vrml(body, files).scene.has_value(), i < 3) << i;
  }
}

TEST(DocumentReader, AFileThatIsNamedInTwoWaysIsReadOnce) {
  ReadOptions options;
  options.name = "a.obj";
  options.load = [](std::string_view, std::string_view) -> std::expected<LoadedFile, std::string> {
    return LoadedFile{"folder/a.mtl", "newmtl m\nKd 1 0 0\n"};
  };
  const ReadResult result =
      read_world("mtllib a.mtl\nmtllib ./a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n", options);
  ASSERT_TRUE(result.scene);
  EXPECT_EQ(result.sources.size(), 2U);
}

TEST(DocumentReader, DeepInlinedFilesAreRefused) {
  std::string nodes;
  for (int i = 1; i < 250; ++i) nodes += "{\"children\":[" + std::to_string(i) + "]},";
  const std::string gltf = "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[" + nodes + "{}],\"scenes\":[{\"nodes\":[0]}]}";
  std::string body = "Inline { url \"b.gltf\" }";
  for (int i = 0; i < 20; ++i) body = "Group { children " + body + " }";
  EXPECT_THAT(error_of(read_vrml(body, {{"b.gltf", gltf}})), HasSubstr("nested more than 256 deep"));
}

}  // namespace
}  // namespace peerd::formats::document_reader_test
