#include <gmock/gmock.h>

#include "tests/peerd/cli/program/program.hpp"

namespace peerd::world_commands_test {

using testing::HasSubstr;
using testing_support::kStillWorld;
using testing_support::Program;
using testing_support::Said;

TEST_F(Program, AWorldMayComeFromStandardInput) {
  folder.write("part.wrl", kStillWorld);
  folder.write("w.wrl", "#VRML V2.0 utf8\nInline { url \"part.wrl\" }\n");
  EXPECT_THAT(run("check - <w.wrl").out, HasSubstr("in 2 files")) << "URLs start from the current folder";
  EXPECT_EQ(run("collide - <w.wrl").exit_code, 0);
  const Said bad = run("collide - </dev/null");
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_THAT(bad.err, HasSubstr("<stdin>:1:1: error: "));
  EXPECT_EQ(run("check - <&-").exit_code, 3);
}

}  // namespace peerd::world_commands_test
