#include <gmock/gmock.h>

#include <string>

#include "tests/peerd/program/program.hpp"

namespace peerd::scenario_commands_test {

using testing::HasSubstr;
using testing_support::kMovingBox;
using testing_support::kStillWorld;
using testing_support::Program;
using testing_support::Said;

TEST_F(Program, MotionsWithoutEffectAreNamed) {
  folder.write("w.wrl", std::string(kStillWorld) + "DEF FLOOR Transform { }\n");
  folder.write("s.toml", std::string(kMovingBox) + "[motion.FLOOR]\nx = \"t\"\n");
  const Said said = run("sim s.toml");
  EXPECT_EQ(said.exit_code, 0) << said.err;
  EXPECT_THAT(said.err, HasSubstr("s.toml:8:1: warning: motion.FLOOR has no effect: no peer owns what it names"));
  EXPECT_THAT(said.out, HasSubstr("0 s of 1 run in "));
}

}  // namespace peerd::scenario_commands_test
