#pragma once
#include <termios.h>
#include <chrono>

#include "peerd/cli/client/top_screen.hpp"

namespace peerd {

// The terminal of this process while a screen stands on it: its alternate screen, without a cursor, and keys that come
// one by one and unseen. All is as before once it is destroyed, also where a signal ends the command by StopSignals.
class Terminal {
 public:
  // Standard input and output are a terminal.
  [[nodiscard]] static bool is_there();
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  [[nodiscard]] ScreenSize size() const;
  void show(const std::string& screen) const;  // in place of the one before

  enum class Waited { kOver, kKey, kInterrupted };
  // Waits for that long, for a key, or for a signal, whichever is first; a key is read into `key`.
  [[nodiscard]] Waited wait(std::chrono::milliseconds time, char& key) const;

 private:
  termios before_{};
};

}  // namespace peerd
