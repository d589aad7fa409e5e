#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace peerd {

// A program that runs as a child of this process and writes its output to a file. The child ends at the latest with
// this object, or gets SIGTERM when this process is gone. To be made in a thread that lives as long as the process.
class ChildProcess {
 public:
  // `name` is what messages call it, `command` the program and its arguments. A program that cannot be started counts
  // as one that has ended with exit code 3.
  ChildProcess(std::string name, const std::vector<std::string>& command, const std::filesystem::path& output);
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  // Sends SIGTERM, and SIGKILL where the child has not ended within a second.
  ~ChildProcess();

  [[nodiscard]] bool running();
  // Makes the child leave (SIGTERM), or ends it at once (SIGKILL).
  void end(int signal);
  [[nodiscard]] bool killed() const { return killed_; }
  // The child's exit code; 3 where a signal or the system ended it.
  [[nodiscard]] int exit_code() const;
  [[nodiscard]] std::optional<int> signal() const;  // that has ended the child; none: it ended by itself
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::filesystem::path& output() const { return output_; }

 private:
  std::string name_;
  std::filesystem::path output_;
  pid_t pid_ = -1;
  int status_ = 0;
  bool done_ = false, killed_ = false;
};

}  // namespace peerd
