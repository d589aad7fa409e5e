#include "peerd/cli/client/terminal.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <iostream>
#include <string>

namespace peerd {
namespace {

// ECMA-48 and xterm's control sequences.
constexpr const char* kAlternateScreen = "\x1b[?1049h\x1b[?25l";
constexpr const char* kNormalScreen = "\x1b[?25h\x1b[?1049l";
constexpr const char* kHome = "\x1b[H";
constexpr const char* kClearToEndOfLine = "\x1b[K";
constexpr const char* kClearBelow = "\x1b[J";

}  // namespace

bool Terminal::is_there() { return isatty(STDIN_FILENO) == 1 && isatty(STDOUT_FILENO) == 1; }

Terminal::Terminal() {
  if (tcgetattr(STDIN_FILENO, &before_) == 0) {
    termios keys = before_;
    keys.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    tcsetattr(STDIN_FILENO, TCSANOW, &keys);
  }
  std::cout << kAlternateScreen << std::flush;
}

Terminal::~Terminal() {
  std::cout << kNormalScreen << std::flush;
  tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

ScreenSize Terminal::size() const {
  winsize window{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) != 0 || window.ws_row == 0 || window.ws_col == 0) return {};
  // A full last line would scroll the screen.
  return {static_cast<std::size_t>(window.ws_row) - 1, window.ws_col};
}

void Terminal::show(const std::string& screen) const {
  std::string out = kHome;
  for (const char c : screen) {
    if (c == '\n') out += kClearToEndOfLine;
    out += c;
  }
  std::cout << out << kClearBelow << std::flush;
}

Terminal::Waited Terminal::wait(std::chrono::milliseconds time, char& key) const {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  const int ready = poll(&input, 1, static_cast<int>(time.count()));
  if (ready < 0) return Waited::kInterrupted;
  return ready > 0 && read(STDIN_FILENO, &key, 1) == 1 ? Waited::kKey : Waited::kOver;
}

}  // namespace peerd
