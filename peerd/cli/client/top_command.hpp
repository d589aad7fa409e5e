#pragma once
#include <cstdint>
#include <string>

namespace peerd {

struct TopOptions {
  std::string socket;       // path of the peer's socket; empty: found by its name
  std::string name;         // the peer's name; empty: the only peer of this user
  double every_s = 1.0;     // from one screen to the next [s], > 0
  std::uint64_t count = 0;  // the number of screens after which it ends; 0: until a key or a signal ends it
};

// `peerd top`: shows a peer of this computer on the terminal, again and again, until q, a signal or the peer's end.
// Without a terminal it prints the screens one after the other.
[[nodiscard]] int run_top(const TopOptions& options);

}  // namespace peerd
