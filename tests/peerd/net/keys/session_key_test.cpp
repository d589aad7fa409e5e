#include "peerd/net/keys/session_key.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>

#include "peerd/net/keys/key_file.hpp"
#include "peerd/net/keys/password.hpp"
#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::keys {
namespace {

using testing::HasSubstr;

class SessionKeys : public testing::Test {
 protected:
  SessionKeys() { setenv("XDG_CONFIG_HOME", (folder / "settings").c_str(), 1); }
  ~SessionKeys() override { unsetenv("XDG_CONFIG_HOME"); }
  testing_support::ScratchFolder folder;
};

TEST_F(SessionKeys, AreThisUsersOwnUnlessSomebodySaysAnother) {
  EXPECT_FALSE(session_key({}, "town", IfMissing::kFail)) << "which is not there";
  const auto own = must(session_key({}, "town", IfMissing::kMake));
  EXPECT_EQ(own.by, "the key " + (folder / "settings/peerd/keys/town.key").string());
  EXPECT_EQ(session_key({}, "town", IfMissing::kFail).value().key, own.key);

  const auto file = folder / "other.key";
  EXPECT_FALSE(session_key({.key_file = file, .password_file = {}}, "town", IfMissing::kMake))
      << "nobody makes one that was said";
  const auto other = must(read_or_make_key(file));
  EXPECT_EQ(session_key({.key_file = file, .password_file = {}}, "town", IfMissing::kFail).value().key, other);
}

TEST_F(SessionKeys, AreMadeByAPassword) {
  folder.write("password", "correct horse\n");
  const auto file = folder / "password";
  ASSERT_EQ(::chmod(file.c_str(), 0600), 0);
  const auto made = must(session_key({.key_file = {}, .password_file = file}, "town", IfMissing::kMake));
  EXPECT_EQ(made.by, "a password");
  EXPECT_EQ(made.key, key_of_password("correct horse", "town").value());
  EXPECT_FALSE(std::filesystem::exists(folder / "settings")) << "no file gets it";
}

TEST_F(SessionKeys, AreOneEach) {
  EXPECT_THAT(error_of(session_key({.key_file = "a", .password_file = "b"}, "town", IfMissing::kMake)),
              IsError(2, HasSubstr("a key's file or a password's, not both")));
}

}  // namespace
}  // namespace peerd::keys
