#include <gmock/gmock.h>

#include <string>

#include "tests/peerd/cli/program/program.hpp"

namespace peerd::peer_commands_test {

using testing::HasSubstr;
using testing_support::Program;
using testing_support::Said;

TEST_F(Program, EndlessFilesAreRefused) {
  for (const char* words : {"sim", "scenario", "run -c", "doctor -c", "replay --size-max 1"}) {
    const Said said = run(std::string(words) + " /dev/zero");
    EXPECT_THAT(said.exit_code, testing::AnyOf(1, 2)) << words;
    EXPECT_THAT(said.err, HasSubstr("/dev/zero: error: it is larger than ")) << words;
  }
  EXPECT_THAT(run("replay --size-max 1 /dev/zero").err, HasSubstr("--size-max allows more"));
}

}  // namespace peerd::peer_commands_test
