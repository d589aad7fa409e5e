#include <gmock/gmock.h>

#include <string>

#include "tests/peerd/cli/program/program.hpp"

namespace peerd::help_commands_test {

using testing::HasSubstr;
using testing_support::Program;

TEST_F(Program, HelpAndVersionAreCommands) {
  EXPECT_EQ(run("help").out, run("--help").out);
  EXPECT_EQ(run("help ctl pose").out, run("ctl pose --help").out);
  EXPECT_EQ(run("version").out, run("--version").out);
  EXPECT_EQ(run("version").exit_code, 0);
}

TEST_F(Program, HelpNamesDefaultsAndExitCodes) {
  EXPECT_THAT(run("collide --help").out, HasSubstr("ticks a second (default: 60)"));
  EXPECT_THAT(run("run --help").out, HasSubstr("else 47474)"));
  for (const char* words : {"", "run", "record", "replay", "sim", "scenario", "check", "collide", "volumes", "bake",
                            "doctor", "ctl", "store"}) {
    EXPECT_THAT(run(std::string("help ") + words).out, HasSubstr("Exit codes: 0 ")) << words;
  }
}

}  // namespace peerd::help_commands_test
