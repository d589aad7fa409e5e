#include <gmock/gmock.h>

#include "tests/peerd/cli/program/program.hpp"

namespace peerd::session_commands_test {

using testing::HasSubstr;
using testing_support::Program;
using testing_support::Said;

TEST_F(Program, DoctorNamesSettingsWithoutEffect) {
  const Said said = run("doctor --interface lo --set foo=1 --set ttl=4 --set transport.ttl=4");
  EXPECT_THAT(said.err, HasSubstr("warning: --set foo has no effect: the table [transport] alone counts here\n"));
  EXPECT_THAT(said.err, HasSubstr("warning: --set ttl has no effect"));
  EXPECT_THAT(said.err, HasSubstr("did you mean transport.ttl?\n"));
  EXPECT_THAT(said.err, testing::Not(HasSubstr("--set transport.ttl")));
}

}  // namespace peerd::session_commands_test
