#include "peerd/scenario/child_process.hpp"

#include <chrono>
#include <csignal>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace peerd {

ChildProcess::ChildProcess(std::string name, const std::vector<std::string>& command,
                           const std::filesystem::path& output)
    : name_(std::move(name)), output_(output) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawnattr_t attributes;  // the child gets the signals that its parent blocks
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  if (posix_spawnp(&pid_, arguments[0], &files, &attributes, arguments.data(), environ) != 0) pid_ = -1;
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
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

int ChildProcess::exit_code() const { return pid_ > 0 && WIFEXITED(status_) ? WEXITSTATUS(status_) : 3; }

}  // namespace peerd
