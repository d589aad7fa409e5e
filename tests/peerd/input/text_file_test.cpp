#include "peerd/input/text_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/peerd/scratch_folder.hpp"

namespace peerd::text_file_test {

using testing::HasSubstr;

TEST(ReadTextFile, SaysWhyNot) {
  const testing_support::ScratchFolder folder;
  const auto none = read_text_file(folder / "none.toml");
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().text, HasSubstr("none.toml: error: there is no such file"));
  EXPECT_EQ(none.error().exit_code, 2);
  const auto directory = read_text_file(folder.path());
  ASSERT_FALSE(directory);
  EXPECT_THAT(directory.error().text, HasSubstr("can't be read"));
  EXPECT_EQ(directory.error().exit_code, 3);
  EXPECT_EQ(read_text_file(folder.write("empty", "")), "");
  const std::string bytes("a\0\r\nb", 5);
  EXPECT_EQ(read_text_file(folder.write("bytes", bytes)), bytes);
}

}  // namespace peerd::text_file_test
