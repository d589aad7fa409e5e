// `peerd top` at a real peer, without a terminal and on a real one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>

#include "tests/net/listener.hpp"
#include "tests/net/process.hpp"

namespace peerd::top_command_test {

using net::testing_support::own_port;
using testing::EndsWith;
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

// Types `keys` once the first screen stands, and returns all that the terminal was given, with the exit code.
std::pair<std::string, int> on_terminal(const std::string& socket, const std::string& keys) {
  int terminal = -1;
  winsize window{20, 70, 0, 0};
  const pid_t child = forkpty(&terminal, nullptr, nullptr, &window);
  if (child == 0) {
    execl(PEERD_PROGRAM, "peerd", "top", "--control", socket.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  std::string shown;
  bool typed = false;
  char part[4096];
  for (ssize_t n = read(terminal, part, sizeof part); n > 0; n = read(terminal, part, sizeof part)) {
    shown.append(part, static_cast<std::size_t>(n));
    if (!typed && shown.find("each second") != std::string::npos) {
      typed = write(terminal, keys.data(), keys.size()) == static_cast<ssize_t>(keys.size());
    }
  }
  close(terminal);
  int status = 0;
  waitpid(child, &status, 0);
  return {shown, WIFEXITED(status) ? WEXITSTATUS(status) : -1};
}

TEST_F(Top, LeavesTheTerminalAsItWas) {
  const auto [shown, code] = on_terminal(socket, "xq");
  EXPECT_EQ(code, 0);
  EXPECT_THAT(shown, StartsWith("\x1b[?1049h\x1b[?25l"));
  EXPECT_THAT(shown, HasSubstr("a (id 1) "));
  EXPECT_THAT(shown, EndsWith("\x1b[?25h\x1b[?1049l"));
}

TEST_F(Top, LeavesTheTerminalAsItWasWhereCtrlCEndsIt) {
  const auto [shown, code] = on_terminal(socket, "\x03");
  EXPECT_EQ(code, 130);
  EXPECT_THAT(shown, EndsWith("\x1b[?25h\x1b[?1049l"));
}

}  // namespace peerd::top_command_test
