#pragma once
#include <string>

namespace peerd {

struct CtlOptions {
  std::string socket;   // where the peer listens; empty: found by its name
  std::string name;     // of the peer; empty: the only one of this user's
  std::string request;  // a line of peerd/api/README.md
  bool json = false;    // print the reply as it came
};

// peerd ctl: asks or tells a peer that runs on this computer. 1 when a key did not do all that it should, or a pose is
// not used.
[[nodiscard]] int run_ctl(const CtlOptions& options);

}  // namespace peerd
