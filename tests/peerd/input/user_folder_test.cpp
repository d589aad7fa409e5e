#include "peerd/input/user_folder.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace peerd::user_folder_test {
namespace {

TEST(UserFolder, IsTheVariablesElseBelowHome) {
  const std::string home = std::getenv("HOME") != nullptr ? std::getenv("HOME") : "";
  const auto with = [](const char* folder, const char* of_user) {
    folder != nullptr ? setenv("PEERD_TEST_HOME", folder, 1) : unsetenv("PEERD_TEST_HOME");
    of_user != nullptr ? setenv("HOME", of_user, 1) : unsetenv("HOME");
    return user_folder("PEERD_TEST_HOME", ".local/state");
  };
  EXPECT_EQ(with("/s", "/h"), std::filesystem::path("/s"));
  EXPECT_EQ(with("relative", "/h"), std::filesystem::path("/h/.local/state"));
  EXPECT_EQ(with(nullptr, "/h"), std::filesystem::path("/h/.local/state"));
  EXPECT_EQ(with(nullptr, "relative"), std::nullopt);
  EXPECT_EQ(with(nullptr, nullptr), std::nullopt);
  if (!home.empty()) setenv("HOME", home.c_str(), 1);
}

}  // namespace
}  // namespace peerd::user_folder_test
