#include "peerd/net/keys/key_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <thread>
#include <vector>

#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::keys {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::ScratchFolder;

class KeyFiles : public testing::Test {
 protected:
  // The reason for which it is refused; empty: it is read.
  [[nodiscard]] std::string refusal() const {
    const auto key = read_key(file);
    return key ? "" : key.error().text;
  }
  ScratchFolder folder;
  const fs::path file = folder / "keys/world.key";
};

TEST_F(KeyFiles, AreMadeOnceForThisUserAlone) {
  const auto made = must(read_or_make_key(file));
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(must(read_or_make_key(file)), made);
  EXPECT_EQ(std::distance(fs::directory_iterator(file.parent_path()), fs::directory_iterator()), 1)
      << "no draft is left";
}

TEST_F(KeyFiles, WhoMakeOneAtOnceGetOneKey) {
  std::vector<std::string> texts(8);
  {
    std::vector<std::jthread> threads;
    for (std::string& text : texts) {
      threads.emplace_back([&] { text = read_or_make_key(file).value().text(); });
    }
  }
  EXPECT_THAT(texts, testing::Each(texts.front()));
}

TEST_F(KeyFiles, AreRefusedWhereOthersMayReadThem) {
  ASSERT_TRUE(read_or_make_key(file));
  for (const mode_t mode : {0640u, 0604u, 0620u, 0602u}) {
    ASSERT_EQ(::chmod(file.c_str(), mode), 0);
    EXPECT_THAT(refusal(), HasSubstr("chmod 600")) << std::oct << mode;
  }
  ASSERT_EQ(::chmod(file.c_str(), 0400), 0);
  EXPECT_EQ(refusal(), "");
}

TEST_F(KeyFiles, AreRefusedWhereTheyHaveNoKey) {
  EXPECT_THAT(refusal(), HasSubstr("cannot be read: No such file"));
  fs::create_directory(file.parent_path());
  const std::string text = SymmetricKey::random().text();
  for (const std::string& content :
       {std::string(), text.substr(1), text + "\n\n", text + text, std::string(200, 'a')}) {
    folder.write("keys/world.key", content);
    ASSERT_EQ(::chmod(file.c_str(), 0600), 0);
    EXPECT_THAT(refusal(), HasSubstr("has no key")) << content;
    EXPECT_THAT(refusal(), testing::Not(HasSubstr(text.substr(20, 10)))) << "which may be a secret all the same";
  }
  folder.write("keys/world.key", text);
  EXPECT_EQ(refusal(), "") << "without the end of the line";
  fs::remove(file);
  fs::create_directory(file);
  EXPECT_THAT(refusal(), HasSubstr("is no file"));
}

TEST_F(KeyFiles, AreWhatIsSaidElseAmongThisUsersSettings) {
  setenv("XDG_CONFIG_HOME", "/c", 1);
  EXPECT_EQ(default_key_file("a/b"), fs::path("/c/peerd/keys/a%2Fb.key")) << "a_b has another one";
  EXPECT_EQ(default_key_file("a%2Fb"), fs::path("/c/peerd/keys/a%252Fb.key"));
  EXPECT_EQ(default_key_file("100%"), fs::path("/c/peerd/keys/100%.key"));
  EXPECT_EQ(chosen_key_file("", "a/b").value(), fs::path("/c/peerd/keys/a%2Fb.key"));
  EXPECT_EQ(chosen_key_file("said.key", "a/b").value(), fs::path("said.key"));
  unsetenv("XDG_CONFIG_HOME");
}

TEST_F(KeyFiles, OfAnInvitationAreKeptUnlessThereIsAnother) {
  const SymmetricKey key = SymmetricKey::random();
  ASSERT_TRUE(keep_key(file, key));
  EXPECT_TRUE(keep_key(file, key)) << "the same once more";
  EXPECT_THAT(error_of(keep_key(file, SymmetricKey::random())).text, HasSubstr("move that file away"));
  EXPECT_EQ(read_key(file).value(), key);
}

}  // namespace
}  // namespace peerd::keys
