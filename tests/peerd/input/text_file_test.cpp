#include "peerd/input/text_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

#include "tests/peerd/scratch_folder.hpp"

namespace peerd::text_file_test {

using testing::HasSubstr;

TEST(ReadTextFile, SaysWhyNot) {
  const testing_support::ScratchFolder folder;
  const auto none = read_text_file(folder / "none.toml", kSettingsFile);
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().text, HasSubstr("none.toml: error: there is no such file"));
  EXPECT_EQ(none.error().exit_code, 2);
  const auto directory = read_text_file(folder.path(), kSettingsFile);
  ASSERT_FALSE(directory);
  EXPECT_THAT(directory.error().text, HasSubstr("can't be read"));
  EXPECT_EQ(directory.error().exit_code, 3);
  EXPECT_EQ(read_text_file(folder.write("empty", ""), kSettingsFile), "");
  const std::string bytes("a\0\r\nb", 5);
  EXPECT_EQ(read_text_file(folder.write("bytes", bytes), kSettingsFile), bytes);
}

TEST(ReadTextFile, EndsAtALimit) {
  const testing_support::ScratchFolder folder;
  constexpr SizeLimit kLimit{2 * kMiB, "--more allows more", 2};
  const auto file = folder.write("w", std::string(2 * kMiB, 'x'));
  EXPECT_EQ(read_text_file(file, kLimit)->size(), 2 * kMiB);
  std::ofstream(file, std::ios::app) << 'x';
  const auto larger = read_text_file(file, kLimit);
  ASSERT_FALSE(larger);
  EXPECT_EQ(larger.error().text, file.string() + ": error: it is larger than 2 MiB; --more allows more");
  EXPECT_EQ(larger.error().exit_code, 2);
  const auto endless = read_text_file("/dev/zero", kLimit);
  ASSERT_FALSE(endless);
  EXPECT_EQ(endless.error().text, "/dev/zero: error: it is larger than 2 MiB; --more allows more");
}

TEST(ReadText, ReadsAStreamToItsEnd) {
  std::istringstream in("some text");
  EXPECT_EQ(read_text(in, "<stdin>", kSettingsFile), "some text");
}

TEST(WriteTextFile, SaysWhyNot) {
  const testing_support::ScratchFolder folder;
  ASSERT_TRUE(write_text_file(folder / "w", "text"));
  EXPECT_EQ(testing_support::text_of(folder / "w"), "text");
  const auto full = write_text_file("/dev/full", "text");
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().text, "/dev/full: error: can't be written: No space left on device");
  EXPECT_EQ(full.error().exit_code, 3);
  EXPECT_THAT(write_text_file(folder / "none/w", "text").error().text, HasSubstr("No such file or directory"));
}

}  // namespace peerd::text_file_test
