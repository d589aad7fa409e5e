#include "core/formats/mesh/off_reader.hpp"

#include <gmock/gmock.h>

#include "tests/core/formats/format_fixture.hpp"

namespace peerd::formats::off_reader_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Off, HasItsFacesAndTheirColours) {
  const ReadResult result =
      read_file("a.off", "OFF # a comment\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n\n0 1 0\n3 0 1 2 255 0 0\n4 3 2 1 0 0 51 255\n");
  const auto shapes = shapes_of(result);
  ASSERT_EQ(shapes.size(), 1U);
  EXPECT_THAT(shapes[0].polygons, ElementsAre(ElementsAre(0, 1, 2), ElementsAre(3, 2, 1, 0)));
  EXPECT_EQ(shapes[0].points[2], Vec3(1, 1, 0));
  EXPECT_THAT(vrml::floats_of(*result.scene->document, "Color", "color"),
              ElementsAre(ElementsAre(1, 0, 0, 0, 0.2F, 1)));
}

TEST(Off, CountsMayStandBehindTheHeaderAndPointsMayHaveColours) {
  const ReadResult result = read_file("a.off", "COFF 3 1 0\n0 0 0 1 0 0 1\n1 0 0 0 1 0 1\n0 1 0 0 0.5 0 1\n3 0 1 2\n");
  EXPECT_EQ(shapes_of(result).size(), 1U);
  EXPECT_THAT(vrml::floats_of(*result.scene->document, "Color", "color"),
              ElementsAre(ElementsAre(1, 0, 0, 0, 1, 0, 0, 0.5F, 0)));
}

TEST(Off, NumbersThatAreNotKeptAreNamed) {
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n", face = "3 0 1 2\n";
  EXPECT_THAT(warnings_of(read_file("a.off", "OFF\n3 1 0\n0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n" + face)),
              ElementsAre(HasSubstr("a.off:3: numbers behind the coordinates of points are not kept: with the header "
                                    "COFF they are colours")));
  EXPECT_THAT(warnings_of(read_file("a.off", "NOFF\n3 1 0\n0 0 0 0 0 1 9\n1 0 0 0 0 1\n0 1 0 0 0 1\n" + face)),
              ElementsAre(HasSubstr("normals"), HasSubstr("a.off:3: numbers behind")));
  EXPECT_THAT(warnings_of(read_file("a.off", "OFF\n3 1 0\n" + points + "3 0 1 2 7\n")),
              ElementsAre(HasSubstr("a.off:6: numbers behind the corners of faces are not kept")));
  EXPECT_THAT(
      warnings_of(read_file("a.off", "COFF\n3 1 0\n0 0 0 1 0 0 1\n1 0 0 1 0 0 1\n0 1 0 1 0 0 1\n3 0 1 2 1 0 0\n")),
      ElementsAre(HasSubstr("a.off:6: numbers behind the corners of faces are not kept: the points have colours")));
  EXPECT_THAT(warnings_of(read_file("a.off", "OFF\n3 1 0\n" + points + "3 0 1 2 255 0 0 51\n")),
              ElementsAre(HasSubstr("the opacity of colours is not kept")));
  EXPECT_THAT(warnings_of(read_file("a.off", "OFF\n3 1 0\n" + points + "3 0 1 2 255 0 0 255\n")), testing::IsEmpty());
}

struct Bad {
  const char* text;
  const char* why;
};
class BadOff : public testing::TestWithParam<Bad> {};
TEST_P(BadOff, IsOneSentence) { EXPECT_THAT(error_of(read_file("a.off", GetParam().text)), HasSubstr(GetParam().why)); }
INSTANTIATE_TEST_SUITE_P(Table, BadOff,
                         testing::Values(Bad{"OFF\n", "counts"}, Bad{"OFF\n1000000000 1 0\n", "too short"},
                                         Bad{"OFF\n-1 1 0\n", "counts"}, Bad{"OFF BINARY\n", "binary OFF"},
                                         Bad{"4OFF\n1 0 0\n", "three dimensions"},
                                         Bad{"OFF\n1 1 0\n0 0 0\n3 0 0 1\n", "'1' is no index"},
                                         Bad{"OFF\n1 1 0\n0 0 0\n9 0 0 0\n", "number of corners"},
                                         Bad{"OFF\n1 1000000000 0\n0 0 0\n", "ends at face 0"},
                                         Bad{"OFF\n1 0 0\n0 0 x\n", "'x'"},
                                         Bad{"OFF\n1 0 0\n0 0 0\n9\n", "end of the file"}));

}  // namespace
}  // namespace peerd::formats::off_reader_test
