#pragma once
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/peerd/comes_true.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::testing_support {

// The real program as a child of the test. Its output goes to files, so that a full pipe never blocks it. The
// destructor kills the child, and no other process.
class Process {
 public:
  // Stores are there by default, unless a test has said where.
  static void keep_state_in(const std::string& state) {
    static std::string chosen;
    const char* const now = getenv("XDG_STATE_HOME");
    if (now != nullptr && chosen != now) return;
    chosen = state;
    setenv("XDG_STATE_HOME", chosen.c_str(), 1);
  }
  // `arguments` follow the program's name. Who has other `settings` is another user, with other keys.
  Process(const ScratchFolder& folder, const std::string& name, const std::string& program,
          std::vector<std::string> arguments, const std::string& settings = "settings")
      : out_(folder / (name + ".out")), err_(folder / (name + ".err")) {
    setenv("XDG_CONFIG_HOME", (folder / settings).c_str(), 1);
    keep_state_in(folder / (settings + "-state"));
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, out_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, err_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    arguments.insert(arguments.begin(), program);
    std::vector<char*> argv;
    for (std::string& word : arguments) argv.push_back(word.data());
    argv.push_back(nullptr);
    const int error = posix_spawn(&pid_, program.c_str(), &files, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    if (error != 0) throw std::runtime_error("can't start " + program);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process() {
    if (!ended_) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
  }

  void signal(int number) const {
    if (!ended_) kill(pid_, number);  // a child that has not been waited for keeps its id
  }
  [[nodiscard]] bool running() {
    if (!ended_) ended_ = waitpid(pid_, &status_, WNOHANG) == pid_;
    return !ended_;
  }
  // The exit code; -1 where a signal has ended it, -2 where it is still running after that time.
  [[nodiscard]] int exit_code(double within_s) {
    if (!comes_true([&] { return !running(); }, within_s)) return -2;
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : -1;
  }
  // Waits until the text is in its standard output.
  [[nodiscard]] bool says(const std::string& words, double within_s) {
    return comes_true([&] { return out().find(words) != std::string::npos; }, within_s);
  }
  // The words that the list of processes shows of it.
  [[nodiscard]] std::string command_line() const {
    return text_of(std::filesystem::path("/proc") / std::to_string(pid_) / "cmdline");
  }
  [[nodiscard]] std::string out() const { return text_of(out_); }
  [[nodiscard]] std::string err() const { return text_of(err_); }

 private:
  std::filesystem::path out_, err_;
  pid_t pid_ = -1;
  int status_ = 0;
  bool ended_ = false;
};

}  // namespace peerd::testing_support
