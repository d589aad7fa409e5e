#include "peerd/input/secret_line.hpp"

#include <poll.h>
#include <sys/signalfd.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <iostream>
#include <system_error>

namespace peerd {
namespace {

std::unexpected<InputError> no_secret(const std::string& what, const std::string& why) {
  return std::unexpected(InputError{"error: " + what + ": " + why, kWrongUse});
}

// A terminal that does not show what is typed. Signals that end a process wait until the terminal is as before: while
// one does, wait_for_input() is false.
class WithoutEcho {
 public:
  explicit WithoutEcho(int descriptor) : descriptor_(descriptor), is_terminal_(tcgetattr(descriptor, &before_) == 0) {
    if (!is_terminal_) return;
    sigset_t ending;
    sigemptyset(&ending);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) sigaddset(&ending, signal);
    pthread_sigmask(SIG_BLOCK, &ending, &signals_before_);
    signals_ = signalfd(-1, &ending, SFD_CLOEXEC);
    termios silent = before_;
    silent.c_lflag &= ~static_cast<tcflag_t>(ECHO);
    silent.c_lflag |= static_cast<tcflag_t>(ECHONL);
    tcsetattr(descriptor, TCSAFLUSH, &silent);
  }
  WithoutEcho(const WithoutEcho&) = delete;
  WithoutEcho& operator=(const WithoutEcho&) = delete;
  ~WithoutEcho() {
    if (!is_terminal_) return;
    tcsetattr(descriptor_, TCSANOW, &before_);
    if (signals_ >= 0) ::close(signals_);
    pthread_sigmask(SIG_SETMASK, &signals_before_, nullptr);
  }
  [[nodiscard]] bool is_terminal() const { return is_terminal_; }
  [[nodiscard]] bool wait_for_input() const {
    std::array<pollfd, 2> awaited{{{descriptor_, POLLIN, 0}, {signals_, POLLIN, 0}}};
    while (poll(awaited.data(), awaited.size(), -1) < 0 && errno == EINTR) {
    }
    return awaited[1].revents == 0;
  }

 private:
  int descriptor_;
  termios before_{};
  bool is_terminal_;  // which is found out by reading `before_`
  int signals_ = -1;
  sigset_t signals_before_{};
};

}  // namespace

Result<SecretText> read_secret_line(int descriptor, std::string_view prompt, const std::string& what) {
  const WithoutEcho terminal(descriptor);
  if (terminal.is_terminal()) std::cerr << prompt << std::flush;
  SecretText line;
  for (bool is_first = true;; is_first = false) {
    if (terminal.is_terminal() && !terminal.wait_for_input()) return no_secret(what, "reading it was stopped");
    char c = 0;
    const ssize_t size = ::read(descriptor, &c, 1);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) return no_secret(what, "it cannot be read: " + std::generic_category().message(errno));
    if (size == 0 && is_first) return no_secret(what, "nothing came");
    if (size == 0 || c == '\n') return line;
    if (!line.append(c)) return no_secret(what, "a line may have " + std::to_string(SecretText::kBytesMax) + " bytes");
  }
}

}  // namespace peerd
