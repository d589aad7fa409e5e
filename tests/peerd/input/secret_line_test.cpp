#include "peerd/input/secret_line.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

#include "tests/peerd/comes_true.hpp"

namespace peerd {
namespace {

using testing::HasSubstr;

// A descriptor from which that text comes, and then its end.
class Input {
 public:
  explicit Input(std::string_view text) {
    EXPECT_EQ(pipe(ends_), 0);
    EXPECT_EQ(write(ends_[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
    close(ends_[1]);
  }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;
  ~Input() { close(ends_[0]); }
  // The next line; where there is none, the error.
  [[nodiscard]] std::string line() const {
    const auto read = read_secret_line(ends_[0], "prompt", "the secret");
    return read ? std::string(read->view()) : read.error().text;
  }

 private:
  int ends_[2]{};
};

TEST(SecretLines, AreReadOneByOne) {
  const Input input("one\n\ntwo");
  EXPECT_EQ(input.line(), "one");
  EXPECT_EQ(input.line(), "");
  EXPECT_EQ(input.line(), "two");
  EXPECT_EQ(input.line(), "error: the secret: nothing came");
}

TEST(SecretLines, HaveALimit) {
  const std::string most(SecretText::kBytesMax, 'a');
  EXPECT_EQ(Input(most + "\n").line(), most);
  EXPECT_THAT(Input(most + "a\n").line(), HasSubstr("may have 1024 bytes"));
}

// The two ends of a terminal. At `keys` is who types.
class Terminal {
 public:
  Terminal() : keys(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    EXPECT_EQ(grantpt(keys), 0);
    EXPECT_EQ(unlockpt(keys), 0);
    screen = open(ptsname(keys), O_RDWR | O_NOCTTY | O_CLOEXEC);
    EXPECT_GE(screen, 0);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  ~Terminal() {
    close(keys);
    close(screen);
  }
  [[nodiscard]] bool echoes() const {
    termios now{};
    EXPECT_EQ(tcgetattr(screen, &now), 0);
    return (now.c_lflag & ECHO) != 0;
  }
  void type(std::string_view text) const {
    EXPECT_EQ(write(keys, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  // The text that it has shown, once there is some.
  [[nodiscard]] std::string shown() const {
    pollfd awaited{keys, POLLIN, 0};
    std::string text(100, '\0');
    const ssize_t size = poll(&awaited, 1, 10'000) == 1 ? read(keys, text.data(), text.size()) : 0;
    text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return text;
  }

  int keys, screen = -1;
};

// A child that reads one line from the terminal and ends with 0 where it is that one.
pid_t reader_of(const Terminal& terminal, std::string_view expected) {
  const pid_t child = fork();
  if (child != 0) return child;
  const auto line = read_secret_line(terminal.screen, "", "the secret");
  _exit(line && line->view() == expected ? 0 : 1);
}
void wait_until_hidden(const Terminal& terminal) {
  ASSERT_TRUE(testing_support::comes_true([&] { return !terminal.echoes(); }, 10));
}

TEST(SecretLines, AreNotShownByATerminal) {
  const Terminal terminal;
  ASSERT_TRUE(terminal.echoes());
  const pid_t child = reader_of(terminal, "hush");
  wait_until_hidden(terminal);
  terminal.type("hush\n");
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(terminal.shown(), "\r\n") << "the end of the line alone";
  EXPECT_TRUE(terminal.echoes());
}

TEST(SecretLines, LeaveTheTerminalAsItWasWhereASignalEndsTheProcess) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const Terminal terminal;
    const pid_t child = reader_of(terminal, "hush");
    wait_until_hidden(terminal);
    terminal.type("hus");
    ASSERT_EQ(kill(child, signal), 0);
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << status;
    EXPECT_TRUE(terminal.echoes());
  }
}

}  // namespace
}  // namespace peerd
