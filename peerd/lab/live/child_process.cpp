#include "peerd/lab/live/child_process.hpp"

#include <cassert>
#include <chrono>
#include <csignal>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace peerd {

namespace {

constexpr int kCannotRun = 3;

// Becomes the program. Between fork() and here only calls that are safe in a signal handler are allowed. The child gets
// SIGTERM when its parent is gone, even by SIGKILL: prctl(2), PR_SET_PDEATHSIG.
[[noreturn]] void become(char* const* arguments, const char* output, pid_t parent) {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);  // the child would get the signals that its parent blocks
  const int file = open(output, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const bool written = file >= 0 && dup2(file, STDOUT_FILENO) >= 0 && dup2(file, STDERR_FILENO) >= 0;
  const bool bound = prctl(PR_SET_PDEATHSIG, SIGTERM) == 0 && getppid() == parent;
  if (file > STDERR_FILENO) close(file);
  if (written && bound) execvp(arguments[0], arguments);
  _exit(kCannotRun);
}

}  // namespace

ChildProcess::ChildProcess(std::string name, const std::vector<std::string>& command,
                           const std::filesystem::path& output)
    : name_(std::move(name)), output_(output) {
  assert(!command.empty());
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0) become(arguments.data(), output_.c_str(), parent);
}

ChildProcess::~ChildProcess() {
  if (!running()) return;
  kill(pid_, SIGTERM);
  for (int tries = 0; tries < 50 && running(); ++tries) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  if (!running()) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
}

bool ChildProcess::running() {
  if (pid_ <= 0 || done_) return false;
  done_ = waitpid(pid_, &status_, WNOHANG) == pid_;
  return !done_;
}

void ChildProcess::end(int signal) {
  killed_ = signal == SIGKILL;
  if (running()) kill(pid_, signal);
}

int ChildProcess::exit_code() const { return pid_ > 0 && WIFEXITED(status_) ? WEXITSTATUS(status_) : kCannotRun; }

std::optional<int> ChildProcess::signal() const {
  return done_ && WIFSIGNALED(status_) ? std::optional(WTERMSIG(status_)) : std::nullopt;
}

}  // namespace peerd
