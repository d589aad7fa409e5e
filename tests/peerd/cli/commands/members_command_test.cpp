#include "peerd/cli/commands/members_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include <nlohmann/json.hpp>

#include "peerd/net/keys/identity.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::members_command_test {
namespace {

using testing::HasSubstr;

class Members : public testing::Test {
 protected:
  // The exit code, and what it says in `out` and `error`.
  int run(MembersOptions options) {
    options.world = "town";
    options.roster = folder / "town.roster";
    if (options.identity.empty()) options.identity = folder / "anna.key";
    std::ostringstream stream;
    testing::internal::CaptureStderr();
    const int code = run_members(options, stream);
    error = testing::internal::GetCapturedStderr();
    out = stream.str();
    return code;
  }
  testing_support::ScratchFolder folder;
  std::string out, error;
  const std::string key = keys::Identity::random().public_key().text();
};

TEST_F(Members, BeginAddAndRemove) {
  EXPECT_EQ(run({}), 2);
  EXPECT_THAT(error, HasSubstr("--begin NAME begins one"));
  ASSERT_EQ(run({.begin = "anna"}), 0) << error;
  EXPECT_THAT(out, HasSubstr("administrator"));
  ASSERT_EQ(run({.add = {"bo=" + key}, .role = "observer"}), 0) << error;
  ASSERT_EQ(run({.json = true}), 0) << error;
  const auto shown = nlohmann::json::parse(out);
  EXPECT_EQ(shown.at("epoch"), 2);
  EXPECT_EQ(shown.at("members").at(1).at("role"), "observer");
  EXPECT_EQ(shown.at("members").at(1).at("key"), key);
  ASSERT_EQ(run({.remove = {"bo"}}), 0) << error;
  EXPECT_THAT(out, testing::AllOf(HasSubstr("epoch 3"), HasSubstr("(former)")));
}

TEST_F(Members, AreNotChangedByAnybodyElseNorWrongly) {
  ASSERT_EQ(run({.begin = "anna"}), 0) << error;
  EXPECT_EQ(run({.begin = "anna"}), 2);
  EXPECT_EQ(run({.add = {"bo"}}), 2);
  EXPECT_THAT(error, HasSubstr("say NAME=KEY"));
  EXPECT_EQ(run({.add = {"bo=" + key}, .role = "king"}), 2);
  EXPECT_THAT(error, HasSubstr("there are observer, editor and administrator"));
  EXPECT_EQ(run({.remove = {"cy"}}), 2);
  EXPECT_EQ(run({.identity = folder / "bo.key", .add = {"bo=" + key}}), 2);
  EXPECT_THAT(error, HasSubstr("no administrator"));
  ASSERT_EQ(run({}), 0);
  EXPECT_THAT(out, HasSubstr("epoch 1"));
}

}  // namespace
}  // namespace peerd::members_command_test
