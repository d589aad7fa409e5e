#pragma once
#include <string>

namespace peerd {

// Takes SIGINT and SIGTERM for a command that runs for long. There is at most one at a time.
//
// At first, while nothing could be saved, a signal ends the process at once with a line that says why. From
// `note_from_now_on` on, the first signal is noted for the command to stop by itself, and the second one ends the
// process. A signal that was ignored when the program was started, as a shell does for Ctrl-C in the background, goes
// on being ignored.
class StopSignals {
 public:
  // `at_once`: the line, such as "stopped while reading the world: nothing was run".
  explicit StopSignals(const std::string& at_once);
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  // `at_once`: the line for the second signal.
  void note_from_now_on(const std::string& at_once);

  [[nodiscard]] int signal() const;               // that was noted; 0: none
  [[nodiscard]] std::string signal_name() const;  // of one that was noted
  [[nodiscard]] int exit_code() const;            // as a shell has it for that signal: 130 or 143
};

}  // namespace peerd
