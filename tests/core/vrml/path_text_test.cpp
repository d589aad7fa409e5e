#include "core/vrml/path_text.hpp"

#include <gmock/gmock.h>

#include "core/writer/writer.hpp"
#include "tests/core/formats/format_fixture.hpp"

namespace peerd::path_text_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(PathText, QuotesNamesThatVrmlCouldNotHave) {
  for (const char* const name : {"arm", "arm_2", "a-b", "a/b", "Bein:links"}) EXPECT_EQ(in_path(name), name);
  EXPECT_EQ(in_path("left arm"), "\"left arm\"");
  EXPECT_EQ(in_path("3"), "\"3\"");
  EXPECT_EQ(in_path("a \"b\" \\"), "\"a \\\"b\\\" \\\\\"");
  for (const char* const name : {"left arm", "3", "a \"b\" \\", "a b/c", "Cube.001"})
    EXPECT_EQ(unquoted(in_path(name)), name);
  EXPECT_FALSE(unquoted("arm"));
  EXPECT_FALSE(unquoted("\"arm"));
  EXPECT_FALSE(unquoted("\"a\"b\""));
}

TEST(PathText, IsCutOutsideOfQuotes) {
  EXPECT_EQ(component_end("\"a/b\"/c"), 5U);
  EXPECT_EQ(component_end("a\"b/c"), 3U);
  EXPECT_EQ(last_component("x/\"a/b\""), "\"a/b\"");
  EXPECT_EQ(find_star("\"a*\"/b*"), 6U);
  EXPECT_EQ(list_entry_end("\"a,b\"/\",\"/c,d"), 11U);
  EXPECT_EQ(list_entry_end("a"), 1U);
}

// OBJ takes any name, so its groups show what paths do with them.
TEST(PathText, NamesOfOtherFormatsKeepTheirSpellingInPaths) {
  const std::string face = "\nf 1 2 3\n";
  const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\no left arm" + face + "o 1" + face + "o a/b c" + face +
                           "o Cube.001" + face + "o x*" + face + "o DEF" + face;
  const ReadResult result = formats::read_file("a.obj", text);
  ASSERT_TRUE(result.scene);
  const Scene& scene = *result.scene;
  EXPECT_THAT(paths_of(scene),
              ElementsAre("\"left arm\"", "\"left arm\"/0", "\"1\"", "\"1\"/0", "\"a/b c\"", "\"a/b c\"/0",
                          "\"Cube.001\"", "\"Cube.001\"/0", "x*", "x*/0", "DEF", "DEF/0"));
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i)
    EXPECT_EQ(scene.find(scene.path_of(ObjectId{i})), ObjectId{i});
  EXPECT_EQ(scene.find("left arm"), scene.find("\"left arm\""));
  EXPECT_EQ(scene.find("\"1\""), ObjectId{2});
  EXPECT_EQ(scene.find("1"), ObjectId{2});  // the child of that number, which has that name, too
  EXPECT_EQ(scene.find("4/0"), ObjectId{9});
  // Written as VRML97, they have names that are like them.
  const auto written = write_world(scene);
  ASSERT_TRUE(written);
  EXPECT_THAT(written->text, HasSubstr("DEF left_arm Transform"));
  EXPECT_THAT(written->text, HasSubstr("DEF _1 Transform"));
  EXPECT_THAT(written->text, HasSubstr("DEF Cube_001 Transform"));
  EXPECT_THAT(written->text, HasSubstr("DEF _DEF Transform"));
  EXPECT_EQ(written->notes.size(), 5U);
  EXPECT_TRUE(read_world(written->text).scene);
}

}  // namespace
}  // namespace peerd::path_text_test
