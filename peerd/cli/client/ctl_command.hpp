#pragma once
#include <chrono>
#include <cstdint>
#include <string>

namespace peerd {

struct CtlOptions {
  std::string socket;        // path of the peer's socket; empty: found by its name
  std::string name;          // the peer's name; empty: the only peer of this user
  std::string request;       // a line of the control protocol
  bool json = false;         // print the reply as it came
  bool follows = false;      // a request for events: each is printed, a line as it came
  std::uint64_t events = 0;  // the number of events after which it ends; 0: when the peer ends
  std::string save;          // the file that the world of the reply goes to; empty: it is printed
  // An edit is over once all peers have had the time to take it up, and another peer holds it.
  std::chrono::milliseconds patience = std::chrono::seconds(10);
};

// `peerd ctl`: sends a request to a peer on this computer and prints its reply. Returns 1 when a key did not do all
// that it should, a pose is not used, or an edit has not taken effect.
[[nodiscard]] int run_ctl(const CtlOptions& options);

}  // namespace peerd
