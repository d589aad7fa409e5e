// `peerd top` at a real peer, without a terminal.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/net/listener.hpp"
#include "tests/net/process.hpp"

namespace peerd::top_command_test {

using net::testing_support::own_port;
using testing::HasSubstr;
using testing::StartsWith;
using testing_support::Process;

class Top : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(peer.says("listens for peerd ctl at " + socket, 5)) << peer.out() << peer.err(); }

  testing_support::ScratchFolder folder;
  std::string socket = (folder / "a.sock").string();
  Process peer{
      folder,
      "a",
      PEERD_PROGRAM,
      {"run", "--world", PEERD_SOURCE_DIR "/configs/worlds/keys.wrl", "--name", "a", "--id", "1", "--own", "RED",
       "--interface", "lo", "--port", std::to_string(own_port(15)), "--control", socket, "--store", ""}};
};

TEST_F(Top, PrintsPagesWhereThereIsNoTerminal) {
  Process top(folder, "top", PEERD_PROGRAM, {"top", "--control", socket, "--count", "2", "--every", "0.1"});
  EXPECT_EQ(top.exit_code(10), 0) << top.err();
  EXPECT_THAT(top.out(), StartsWith("a (id 1) "));
  EXPECT_THAT(top.out().substr(1), HasSubstr("\na (id 1) ")) << "the second page";
}

TEST_F(Top, SaysThatNobodyIsThere) {
  Process top(folder, "top", PEERD_PROGRAM, {"top", "--control", (folder / "none.sock").string()});
  EXPECT_EQ(top.exit_code(10), 3);
  EXPECT_THAT(top.err(), HasSubstr("no peer answers"));
}

}  // namespace peerd::top_command_test
