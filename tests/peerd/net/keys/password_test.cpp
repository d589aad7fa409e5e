#include "peerd/net/keys/password.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/peerd/scratch_folder.hpp"

namespace peerd::keys {
namespace {

using testing::HasSubstr;

std::string key_text(std::string_view password, const std::string& world) {
  const auto key = key_of_password(password, world);
  return key ? key->text() : key.error().text;
}

TEST(Passwords, MakeOneKeyForEachWorld) {
  const std::string key = key_text("correct horse", "town");
  // Another implementation has made this one of the parameters in the header: a change would part peers of two
  // versions.
  EXPECT_EQ(key, "peerd-key-1:bKUjbZ5c9JwbLZMw8TNbz3_rnu0wwybXzlyHvsYOpj8");
  EXPECT_EQ(key_text("correct horse", "town"), key);
  EXPECT_NE(key_text("correct horsf", "town"), key);
  EXPECT_NE(key_text("correct horse", "towm"), key);
}

class PasswordFiles : public testing::Test {
 protected:
  [[nodiscard]] std::string read(const std::string& content, mode_t mode = 0600) const {
    folder.write("password", content);
    EXPECT_EQ(::chmod((folder / "password").c_str(), mode), 0);
    const auto text = read_password(folder / "password");
    return text ? std::string(text->view()) : text.error().text;
  }
  testing_support::ScratchFolder folder;
};

TEST_F(PasswordFiles, HaveOneLine) {
  EXPECT_EQ(read("correct horse\n"), "correct horse");
  EXPECT_EQ(read("correct horse"), "correct horse") << "without the end of the line";
  EXPECT_EQ(read("pässwort für alle\n"), "pässwort für alle");
  for (const std::string content : {"correct\nhorse\n", "correct horse\n\n", "correct horse\r\n"}) {
    EXPECT_THAT(read(content), HasSubstr("more than one line, or a control character")) << content;
  }
  for (const std::string content : {"", "\n", "horse12\n"}) EXPECT_THAT(read(content), HasSubstr("is shorter than"));
  EXPECT_THAT(read(std::string(SecretText::kBytesMax + 1, 'a')), HasSubstr("is too long"));
}

TEST_F(PasswordFiles, AreRefusedWhereOthersMayReadThem) {
  const std::string error = read("correct horse\n", 0640);
  EXPECT_THAT(error, HasSubstr("chmod 600"));
  EXPECT_THAT(error, testing::Not(HasSubstr("correct")));
}

}  // namespace
}  // namespace peerd::keys
