#pragma once
#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace peerd {

// Writes lines to standard output without waiting for whoever reads them. A pipe that is full, a terminal that Ctrl-S
// has stopped and a collector that hangs would otherwise stop the peer. Lines that are not taken wait here; when too
// many do, further ones are dropped and counted.
//
// The descriptor of standard output is shared with other programs, which must not find it non-blocking. A pipe or a
// terminal is therefore opened once more, by its name in /proc, and a socket is asked not to wait at each call. Nothing
// else is known to wait for a reader, and such files are written as ever.
class StandardOutput {
 public:
  static constexpr std::size_t kWaiting_bytes = std::size_t{1} << 18;  // of lines that wait; more of them are dropped
  static constexpr int kPatience_ms = 100;  // the destructor's, for a reader that takes nothing more

  StandardOutput() = default;
  // Waits for a reader that goes on reading.
  ~StandardOutput();
  StandardOutput(const StandardOutput&) = delete;
  StandardOutput& operator=(const StandardOutput&) = delete;

  void write(std::string_view line);
  // Gives the reader what waits, as far as it takes it.
  void flush() { (void)give(); }
  // Returns how many lines were dropped since the last call that returned some; 0 while earlier lines still wait.
  [[nodiscard]] std::uint64_t take_dropped();

 private:
  void open();
  bool give();

  std::string waiting_;
  std::size_t given_ = 0;  // bytes of `waiting_`
  std::uint64_t dropped_ = 0;
  int descriptor_ = -1;  // -1: it is written as ever
  bool is_socket_ = false;
  dev_t device_ = 0;  // of what standard output was when it was opened
  ino_t inode_ = 0;
};

}  // namespace peerd
