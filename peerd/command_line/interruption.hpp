#pragma once
#include <csignal>

namespace peerd {

// While an Interruption lives, Ctrl-C (SIGINT) asks the program to stop with what it has. The second Ctrl-C ends the
// program at once, as ever. There is one at a time. A program that was started with SIGINT ignored goes on ignoring it.
class Interruption {
 public:
  Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
  ~Interruption();

  [[nodiscard]] bool requested() const;

 private:
  struct sigaction before_ {};
};

}  // namespace peerd
