#include <gmock/gmock.h>

#include <string>

#include "tests/peerd/cli/program/program.hpp"

namespace peerd::client_commands_test {

using testing::HasSubstr;
using testing_support::Program;
using testing_support::Said;

TEST_F(Program, HexadecimalNumbersAreKeys) {
  const Said said = run("ctl --control '" + (folder / "none").string() + "' key --value 0x1000013");
  EXPECT_THAT(said.err, testing::Not(HasSubstr("--value"))) << "it gets as far as the socket";
}

}  // namespace peerd::client_commands_test
