#include "peerd/net/keys/secret_file.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::keys::secret_file_test {

using testing::HasSubstr;

class SecretFile : public testing::Test {
 protected:
  [[nodiscard]] std::string why_not() const {
    const auto line = read_private_line(file, "key");
    return line ? "" : line.error().text;
  }
  testing_support::ScratchFolder folder;
  std::filesystem::path file = folder / "made/secret";
};

TEST_F(SecretFile, IsThisUsersAloneAndIsMadeOnce) {
  ASSERT_TRUE(make_private_line(file, "key", "a secret"));
  struct stat state {};
  ASSERT_EQ(stat(file.c_str(), &state), 0);
  EXPECT_EQ(state.st_mode & 0777U, 0600U);
  EXPECT_EQ(why_not(), "");
  EXPECT_TRUE(make_private_line(file, "key", "another"));
  EXPECT_EQ(must(read_private_line(file, "key")).view(), "a secret") << "it stays as it is";
}

TEST_F(SecretFile, IsNotReadWhereOthersMayReadIt) {
  ASSERT_TRUE(make_private_line(file, "key", "a secret"));
  ASSERT_EQ(chmod(file.c_str(), 0640), 0);
  EXPECT_THAT(why_not(), HasSubstr(file.string()));
  ASSERT_EQ(chmod(file.c_str(), 0604), 0);
  EXPECT_THAT(why_not(), HasSubstr(file.string()));
}

TEST_F(SecretFile, SaysThatItIsNoFile) {
  EXPECT_THAT(why_not(), HasSubstr("the key " + file.string()));
  ASSERT_TRUE(std::filesystem::create_directories(file));
  EXPECT_THAT(why_not(), HasSubstr("the key " + file.string()));
}

}  // namespace peerd::keys::secret_file_test
