#include "core/formats/mesh/ply_reader.hpp"

#include <gmock/gmock.h>

#include "tests/core/formats/format_fixture.hpp"

namespace peerd::formats::ply_reader_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string header(const std::string& format, const std::string& elements) {
  return "ply\nformat " + format + " 1.0\ncomment by hand\n" + elements + "end_header\n";
}
constexpr const char* kElements =
    "element vertex 4\nproperty double x\nproperty float y\nproperty short z\nproperty uchar red\nproperty uchar "
    "green\nproperty uchar blue\nelement face 2\nproperty list uchar int vertex_indices\nproperty float quality\n";

template <class Append>
std::string body(Append add) {
  std::string bytes;
  for (int i = 0; i < 4; ++i) {
    add(bytes, i * 0.5);
    add(bytes, static_cast<float>(i));
    add(bytes, static_cast<std::int16_t>(-i));
    for (const int color : {255, 0, 51 * i}) add(bytes, static_cast<std::uint8_t>(color));
  }
  add(bytes, static_cast<std::uint8_t>(3));
  for (const std::int32_t i : {0, 1, 2}) add(bytes, i);
  add(bytes, 1.0F);
  add(bytes, static_cast<std::uint8_t>(4));
  for (const std::int32_t i : {3, 2, 1, 0}) add(bytes, i);
  add(bytes, 2.0F);
  return bytes;
}

void expect_the_mesh(const ReadResult& result) {
  const auto shapes = shapes_of(result);
  ASSERT_EQ(shapes.size(), 1U);
  EXPECT_THAT(shapes[0].polygons, ElementsAre(ElementsAre(0, 1, 2), ElementsAre(3, 2, 1, 0)));
  EXPECT_EQ(shapes[0].points, (std::vector<Vec3>{{0, 0, 0}, {0.5, 1, -1}, {1, 2, -2}, {1.5, 3, -3}}));
  EXPECT_THAT(vrml::floats_of(*result.scene->document, "Color", "color"),
              ElementsAre(ElementsAre(1, 0, 0, 1, 0, 0.2F, 1, 0, 0.4F, 1, 0, 0.6F)));
  EXPECT_THAT(warnings_of(result), ElementsAre(HasSubstr("'face' are not kept: quality")));
}

TEST(Ply, IsTheSameInTextAndInBothByteOrders) {
  expect_the_mesh(read_file("a.ply", header("ascii", kElements) +
                                         "0 0 0 255 0 0\n0.5 1 -1 255 0 51\n1 2 -2 255 0 102\n1.5 3 -3 255 0 153\n"
                                         "3 0 1 2 1\n4 3 2 1 0 2\n"));
  expect_the_mesh(read_file(
      "a.ply", header("binary_little_endian", kElements) + body([](std::string& b, auto v) { append(b, v); })));
  expect_the_mesh(read_file(
      "a.ply", header("binary_big_endian", kElements) + body([](std::string& b, auto v) { append_reversed(b, v); })));
}

TEST(Ply, WithoutFacesIsACloudOfPoints) {
  const ReadResult result =
      read_file("a.ply", header("ascii", "element vertex 2\nproperty float x\nproperty float y\nproperty float z\n") +
                             "0 0 0\n1 2 3\n");
  EXPECT_EQ(shapes_of(result).size(), 1U);
  EXPECT_EQ(vrml::nodes_of_type(*result.scene->document, "PointSet").size(), 1U);
}

TEST(Ply, StripsOfTrianglesAreCutIntoThem) {
  const ReadResult result = read_file(
      "a.ply", header("ascii",
                      "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement tristrips "
                      "1\nproperty list int int vertex_indices\n") +
                   "0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 1 3 2\n");
  const auto shapes = shapes_of(result);
  ASSERT_EQ(shapes.size(), 1U);
  EXPECT_THAT(shapes[0].polygons, ElementsAre(ElementsAre(0, 1, 2), ElementsAre(2, 1, 3), ElementsAre(1, 3, 2)));
}

TEST(Ply, ColoursThatAreNotKeptAreNamed) {
  const std::string place = "property float x\nproperty float y\nproperty float z\n";
  EXPECT_THAT(warnings_of(read_file("a.ply", header("ascii", "element vertex 4\n" + place +
                                                                 "element tristrips 1\nproperty list int int "
                                                                 "vertex_indices\nproperty uchar red\nproperty uchar "
                                                                 "green\nproperty uchar blue\n") +
                                                 "0 0 0\n1 0 0\n0 1 0\n1 1 0\n4 0 1 2 3 1 2 3\n")),
              ElementsAre(HasSubstr("'tristrips' are not kept: red, green, blue")));
  EXPECT_THAT(warnings_of(read_file("a.ply", header("ascii", "element vertex 1\n" + place + "property uchar red\n" +
                                                                 "property uchar green\n") +
                                                 "0 0 0 1 1\n")),
              ElementsAre(HasSubstr("'vertex' are not kept: red, green")));
}

struct Bad {
  std::string bytes;
  const char* why;
};
class BadPly : public testing::TestWithParam<Bad> {};
TEST_P(BadPly, IsOneSentence) {
  EXPECT_THAT(error_of(read_file("a.ply", GetParam().bytes)), HasSubstr(GetParam().why));
}

constexpr const char* kPoint = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
INSTANTIATE_TEST_SUITE_P(
    Table, BadPly,
    testing::Values(Bad{"ply\n", "no end_header"}, Bad{"ply\nend_header\n", "names no format"},
                    Bad{"ply\nformat zip 1.0\n", "'zip'"},
                    Bad{header("ascii", "element vertex 1000000000\nproperty float x\n"), "too short for 1000000000"},
                    Bad{header("binary_little_endian", "element vertex 1000000000000\nproperty char x\n"), "too short"},
                    Bad{header("ascii", "element vertex 9223372036854775807\n"), "too short"},
                    Bad{header("ascii", kPoint) + "0 0\n", "missing or wrong"},
                    Bad{header("ascii", kPoint) + "0 0 nan\n", "missing or wrong"},
                    Bad{header("ascii", std::string(kPoint) + "element face 1\nproperty list int int vertex_index\n") +
                            "0 0 0\n3 0 0 1\n",
                        "names no point"},
                    Bad{header("ascii", std::string(kPoint) + "element face 1\nproperty list int int vertex_index\n") +
                            "0 0 0\n3.7 0 0 0\n",
                        "length of a list"},
                    Bad{header("ascii", std::string(kPoint) + "element face 1\nproperty list int int vertex_index\n") +
                            "0 0 0\n3 0 0 0.5\n",
                        "names no point"},
                    Bad{header("binary_little_endian",
                               std::string(kPoint) + "element face 1\nproperty list uint int vertex_index\n") +
                            std::string(12, '\0') + "\xff\xff\xff\x7f",
                        "length of a list"},
                    Bad{header("ascii", "element vertex 1\nproperty float x\n") + "0\n", "no x, y and z"}));

}  // namespace
}  // namespace peerd::formats::ply_reader_test
