#include "peerd/input/text_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "peerd/input/world_file.hpp"
#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::text_file_test {

using testing::HasSubstr;

TEST(ReadTextFile, SaysWhyNot) {
  const testing_support::ScratchFolder folder;
  EXPECT_THAT(error_of(read_text_file(folder / "none.toml", kSettingsFile)),
              IsError(2, HasSubstr("none.toml: error: there is no such file")));
  EXPECT_THAT(error_of(read_text_file(folder.path(), kSettingsFile)), IsError(3, HasSubstr("can't be read")));
  EXPECT_EQ(read_text_file(folder.write("empty", ""), kSettingsFile), "");
  const std::string bytes("a\0\r\nb", 5);
  EXPECT_EQ(read_text_file(folder.write("bytes", bytes), kSettingsFile), bytes);
}

// The superuser may read everything: it reads as nobody while this lives.
class AsNobody {
 public:
  AsNobody() { become(65534); }
  ~AsNobody() { become(0); }

 private:
  void become(uid_t user) const {
    if (!is_superuser_) return;
    EXPECT_EQ(seteuid(user), 0);
  }
  bool is_superuser_ = geteuid() == 0;
};

TEST(ReadTextFile, SaysThatItMayNotBeRead) {
  const testing_support::ScratchFolder folder;
  std::filesystem::permissions(folder.path(), std::filesystem::perms::all);
  std::filesystem::create_directory(folder / "closed");
  const auto hidden = folder.write("closed/w.wrl", "text"), closed = folder.write("w.wrl", "text");
  const auto none = std::filesystem::perms::none;
  std::filesystem::permissions(closed, none);
  std::filesystem::permissions(folder / "closed", none);
  {
    const AsNobody nobody;
    for (const auto& file : {hidden, closed}) {
      EXPECT_THAT(error_of(read_text_file(file, kSettingsFile)),
                  IsError(3, file.string() + ": error: can't be read: Permission denied"));
      EXPECT_EQ(local_files()(file.string(), "").error(), "it can't be read: Permission denied");
    }
  }
  std::filesystem::permissions(folder / "closed", std::filesystem::perms::owner_all);
  const std::string long_name(300, 'x');
  EXPECT_THAT(error_of(read_text_file(folder / long_name, kSettingsFile)), IsError(3, HasSubstr("File name too long")));
  EXPECT_THAT(error_of(read_text_file(folder.path(), kSettingsFile)), IsError(3, HasSubstr("Is a directory")));
}

// Who may not write a file may still remove it, where the folder is theirs: a failure must not.
TEST(WriteTextFile, LeavesAFileThatItMayNotWrite) {
  const testing_support::ScratchFolder folder;
  std::filesystem::permissions(folder.path(), std::filesystem::perms::all);
  const auto kept = folder.write("kept.wrl", "text");
  std::filesystem::permissions(kept, std::filesystem::perms::owner_read);
  {
    const AsNobody nobody;
    const auto written = write_text_file(kept, "other text");
    ASSERT_FALSE(written.has_value());
    EXPECT_THAT(written.error(), IsError(3, kept.string() + ": error: can't be written: Permission denied"));
  }
  EXPECT_EQ(read_text_file(kept, kSettingsFile), "text");
}

TEST(ReadTextFile, EndsAtALimit) {
  const testing_support::ScratchFolder folder;
  constexpr SizeLimit kLimit{2 * kMiB, "--more allows more", 2};
  const auto file = folder.write("w", std::string(2 * kMiB, 'x'));
  EXPECT_EQ(read_text_file(file, kLimit)->size(), 2 * kMiB);
  std::ofstream(file, std::ios::app) << 'x';
  EXPECT_THAT(error_of(read_text_file(file, kLimit)),
              IsError(2, file.string() + ": error: it is larger than 2 MiB; --more allows more"));
  EXPECT_EQ(error_of(read_text_file("/dev/zero", kLimit)).text,
            "/dev/zero: error: it is larger than 2 MiB; --more allows more");
}

TEST(ReadText, ReadsAStreamToItsEnd) {
  std::istringstream in("some text");
  EXPECT_EQ(read_text(in, "<stdin>", kSettingsFile), "some text");
}

TEST(WriteTextFile, SaysWhyNot) {
  const testing_support::ScratchFolder folder;
  ASSERT_TRUE(write_text_file(folder / "w", "text"));
  EXPECT_EQ(testing_support::text_of(folder / "w"), "text");
  EXPECT_THAT(error_of(write_text_file("/dev/full", "text")),
              IsError(3, "/dev/full: error: can't be written: No space left on device"));
  EXPECT_THAT(write_text_file(folder / "none/w", "text").error().text, HasSubstr("No such file or directory"));
}

}  // namespace peerd::text_file_test
