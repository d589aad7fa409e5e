#include "core/formats/mesh/obj_reader.hpp"

#include <gmock/gmock.h>

#include "tests/core/formats/format_fixture.hpp"

namespace peerd::formats::obj_reader_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kHouse =
    "mtllib house.mtl\n"
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 2 0\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "o walls\nusemtl brick\nf 1/1 2/2 3/3 4/4\n"
    "o the roof\nusemtl tile\nf -2 -3 \\\n -1\n"
    "o walls\nusemtl brick\nf 4/4 3/3 2/2 1/1 # the back\n"
    "usemtl none\nl 1 3 5\np 2 4\n";
constexpr const char* kMaterials =
    "newmtl brick\nKd 0.5 0.25 0\nd 0.75\nNs 64\nmap_Kd brick.png\nmap_Bump b.png\nnewmtl tile\nKd 1 0 0\n";

TEST(Obj, GroupsAreTransformsAndMaterialsAreShapes) {
  const ReadResult result = read_file("house.obj", kHouse, {{"house.mtl", kMaterials}, {"brick.png", "\x89PNG"}});
  const auto shapes = shapes_of(result);
  ASSERT_EQ(shapes.size(), 4U);
  EXPECT_EQ(shapes[0].path, "walls/0");
  EXPECT_THAT(shapes[0].polygons, ElementsAre(ElementsAre(0, 1, 2, 3), ElementsAre(3, 2, 1, 0)));
  EXPECT_EQ(result.scene->instances[4].def, "the roof");
  EXPECT_THAT(shapes[3].polygons, ElementsAre(ElementsAre(0, 1, 2)));
  EXPECT_EQ(shapes[3].points, (std::vector<Vec3>{{0, 1, 0}, {1, 1, 0}, {0.5, 2, 0}}));
  const vrml::Document& document = *result.scene->document;
  EXPECT_THAT(vrml::floats_of(document, "Material", "diffuseColor"),
              ElementsAre(ElementsAre(0.5F, 0.25F, 0), ElementsAre(1, 0, 0)));
  EXPECT_THAT(vrml::floats_of(document, "Material", "transparency"), ElementsAre(ElementsAre(0.25F), ElementsAre(0)));
  EXPECT_EQ(vrml::nodes_of_type(document, "ImageTexture").size(), 1U);
  EXPECT_EQ(vrml::nodes_of_type(document, "IndexedLineSet").size(), 1U);
  EXPECT_EQ(vrml::nodes_of_type(document, "PointSet").size(), 1U);
  EXPECT_EQ(result.sources.size(), 3U);  // the materials and the image are parts of the world
  EXPECT_THAT(warnings_of(result), ElementsAre(HasSubstr("house.obj:1: 'house.mtl': what 'map_Bump' says"),
                                               HasSubstr("house.obj:22: there is no material 'none'")));
}

TEST(Obj, ALibraryThatIsNamedAgainIsReadOnce) {
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n", library = "newmtl a\nKd 1 0 0\nmap_Bump b.png\n";
  for (int i = 0; i < 20'000; ++i) text += i % 2 == 0 ? "mtllib m.mtl\n" : "mtllib gone.mtl\n";
  for (int i = 0; i < 100'000; ++i) library += "Kd 0 1 0\n";  // reading it 10,000 times would take minutes
  const ReadResult result = read_file("a.obj", text + "usemtl a\nf 1 2 3\n", {{"m.mtl", library}});
  EXPECT_EQ(shapes_of(result).size(), 1U);
  EXPECT_THAT(warnings_of(result),
              ElementsAre(HasSubstr("a.obj:4: 'm.mtl': what 'map_Bump' says"), HasSubstr("a.obj:5: the materials")));
}

TEST(Obj, ALibraryOfManyUrlsIsReadOnceAndLoadedNoOftenerThanItsSizeAllows) {
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i < 1000; ++i) text += "mtllib " + std::string(static_cast<std::size_t>(i), '/') + "m.mtl\n";
  int loads = 0;
  ReadOptions options;
  options.name = "a.obj";
  options.load = [&](std::string_view, std::string_view) -> std::expected<LoadedFile, std::string> {
    ++loads;
    return LoadedFile{"m.mtl", "newmtl a\nmap_Bump b.png\n" + std::string(400'000, '#')};
  };
  const ReadResult result = read_world(text + "usemtl a\nf 1 2 3\n", options);
  ASSERT_TRUE(result.scene);
  EXPECT_EQ(result.sources.size(), 2U);
  EXPECT_LT(loads, 1000);
  const auto warnings = warnings_of(result);
  EXPECT_EQ(
      std::ranges::count_if(warnings, [](const std::string& w) { return w.find("map_Bump") != std::string::npos; }), 1);
  EXPECT_THAT(warnings, testing::Contains(HasSubstr("more values than a file of this size")));
}

TEST(Obj, WhatOfItsTexturesIsNotKeptIsNamed) {
  const auto read = [](const std::string& texture_points, const std::string& faces) {
    return read_file("a.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n" + texture_points + "usemtl a\n" + faces,
                     {{"m.mtl", "newmtl a\nmap_Kd a.png\n"}, {"a.png", "\x89PNG"}});
  };
  const ReadResult missing = read("vt 0 0\nvt 1 0\nvt 0 1\n", "f 1/1 2/2 3/3\nf 1/1 2/2 3\n");
  EXPECT_EQ(shapes_of(missing).size(), 1U);
  EXPECT_THAT(warnings_of(missing), ElementsAre(HasSubstr("a.obj:9: not all corners")));
  EXPECT_THAT(warnings_of(read("vt 0 0\nvt 1 0 0\nvt 0 1 0.5\nvt 0 1 0 7\n", "f 1/1 2/2 3/3\n")),
              ElementsAre(HasSubstr("a.obj:7: the third number of texture coordinates"),
                          HasSubstr("a.obj:8: more than three numbers of texture coordinates")));
  EXPECT_THAT(warnings_of(read("vt 0 0\nvt 1 0\nvt 0 1\n", "f 1/1 2/2 3/3\n")), testing::IsEmpty());
}

TEST(Obj, NumbersBeyondAPointAreNamed) {
  const std::string face = "v 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_THAT(warnings_of(read_file("a.obj", "v 0 0 0 1 5\n" + face)),
              ElementsAre(HasSubstr("a.obj:1: the fourth and fifth numbers")));
  EXPECT_THAT(warnings_of(read_file("a.obj", "v 0 0 0 2 1 1 1\n" + face)), ElementsAre(HasSubstr("the weights")));
  EXPECT_THAT(warnings_of(read_file("a.obj", "v 0 0 0 1 1 1 1\n" + face)), testing::IsEmpty());
}

TEST(Obj, OfManyUnknownStatementsTheLastNamedOneStandsForTheRest) {
  std::string text = "v 0 0 0 2\nv 1 0 0\nv 0 1 0\nvn 0 0 1\n";
  for (int i = 0; i < 60; ++i) text += "word" + std::to_string(i % 30) + " 1\n";
  const auto warnings = warnings_of(read_file("a.obj", text + "f 1 2 3\n"));
  ASSERT_EQ(warnings.size(), 23U);  // a weight, normals, and 21 statements
  EXPECT_THAT(warnings[21], HasSubstr("'word19' is not read, here and further on"));
  EXPECT_THAT(warnings[22], HasSubstr("'word20' and others are not read, here and further on"));
}

TEST(Obj, WithoutItsMaterialsIsStillAWorldAndSaysSo) {
  const ReadResult result = read_file("house.obj", "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(shapes_of(result).size(), 1U);
  EXPECT_THAT(warnings_of(result),
              ElementsAre("house.obj:1: the materials of 'gone.mtl' are not read: there is no such file"));
}

TEST(Obj, NormalsAndCurvesAreNamedOnce) {
  const ReadResult result =
      read_file("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 1\ns 1\ncurv 1\nf 1//1 2//2 3//-1\n");
  EXPECT_EQ(shapes_of(result).size(), 1U);
  EXPECT_THAT(warnings_of(result), ElementsAre(HasSubstr("a.obj:4: the normals of points (vn) are not kept"),
                                               HasSubstr("a.obj:7: the statement 'curv'")));
}

TEST(Obj, PointsHaveColours) {
  const ReadResult result = read_file("a.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(shapes_of(result).size(), 1U);
  EXPECT_THAT(vrml::floats_of(*result.scene->document, "Color", "color"),
              ElementsAre(ElementsAre(1, 0, 0, 0, 1, 0, 1, 1, 1)));
}

struct Bad {
  const char* text;
  const char* why;
};
class BadObj : public testing::TestWithParam<Bad> {};
TEST_P(BadObj, IsOneSentence) { EXPECT_THAT(error_of(read_file("a.obj", GetParam().text)), HasSubstr(GetParam().why)); }
INSTANTIATE_TEST_SUITE_P(
    Table, BadObj,
    testing::Values(Bad{"v 0 0 0\nf 1 2 3\n", "'2' names no point: there are 1 so far"},
                    Bad{"v 0 0 0\nf -2 1 1\n", "'-2' names no point"}, Bad{"v 0 0 0\nf 0 1 1\n", "'0' names no point"},
                    Bad{"v 0 0 0\nf 99999999999999999999 1 1\n", "names no point"}, Bad{"v 0 0\n", "three coordinates"},
                    Bad{"v 0 0 1e999\n", "expected a coordinate"}, Bad{"v 0 0 nan\n", "expected a coordinate"},
                    Bad{"v 0 0 0\nf 1/1 1/1 1/1\n", "no texture"}, Bad{"v 0 0 0\nf 1//1 1//1 1//1\n", "no normal"},
                    Bad{"v 0 0 0\nf\n", "without corners"}));

TEST(Obj, AShortFileCannotAskForManyNodes) {
  std::string text = "v 0 0 0\n";
  for (int i = 0; i < 200'000; ++i) text += "g " + std::to_string(i) + "\np 1\n";
  EXPECT_THAT(error_of(read_file("a.obj", text)), HasSubstr("more nodes than a file of this size may ask for"));
}

}  // namespace
}  // namespace peerd::formats::obj_reader_test
