#include <gmock/gmock.h>

#include <filesystem>

#include <nlohmann/json.hpp>

#include "tests/peerd/cli/program/program.hpp"

namespace peerd::new_command_test {

using testing::HasSubstr;
using testing_support::Program;
using testing_support::Said;
using testing_support::text_of;

TEST_F(Program, NewWorldsRun) {
  const Said made = run("new first");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("peerd sim first/first.toml\n"));
  const Said checked = run("check first/first.wrl");
  EXPECT_EQ(checked.exit_code, 0) << checked.err;
  EXPECT_EQ(checked.err, "") << "not even a warning";
  const Said simulated = run("sim first/first.toml --json");
  EXPECT_EQ(simulated.exit_code, 0) << simulated.err;
  EXPECT_EQ(simulated.err, "");
  const auto summary = nlohmann::json::parse(simulated.out);
  EXPECT_GE(summary["runs"][0]["collisions"]["shared"]["decided"], 3) << "the ball meets the car again and again";
}

TEST_F(Program, NewWorldsHaveAName) {
  EXPECT_EQ(run("new . --name mine").exit_code, 0);
  EXPECT_THAT(text_of(folder / "mine.toml"), HasSubstr("world = \"mine.wrl\""));
  EXPECT_THAT(text_of(folder / "mine.wrl"), testing::Not(HasSubstr("NAME")));
}

TEST_F(Program, NewWorldsReplaceNothing) {
  folder.write("mine.toml", "precious");
  const Said said = run("new . --name mine");
  EXPECT_EQ(said.exit_code, 2);
  EXPECT_THAT(said.err, HasSubstr("mine.toml already"));
  EXPECT_EQ(text_of(folder / "mine.toml"), "precious");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "mine.wrl"));
}

TEST_F(Program, NewWorldsNeedAGoodNameAndAPlace) {
  for (const char* name : {"--name 'a b'", "--name ../up", "--name=-x"}) {
    EXPECT_EQ(run(std::string("new . ") + name).exit_code, 2) << name;
  }
  folder.write("file", "");
  EXPECT_EQ(run("new file/below").exit_code, 3);
}

}  // namespace peerd::new_command_test
