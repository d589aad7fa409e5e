#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "peerd/input/input_error.hpp"
#include "peerd/peer/config/run_settings.hpp"

namespace peerd {

// A program that stands beside a peer in its island, started before all peers and ended after them: what carries the
// peers' datagrams where network.via says so.
struct Companion {
  std::size_t peer = 0;              // it runs where run.peers[peer] does
  std::string name;                  // of its log: OUT/RUN_NAME.NAME.log
  std::vector<std::string> command;  // the program and its arguments
  std::string ready;                 // words in its log that say that peers can come
};

// The places of the companions of one run.
struct Islands {
  std::filesystem::path stem;           // of their files: OUT/RUN_NAME
  int port = 0;                         // the session's; theirs are from 100 on after it
  std::filesystem::path program = {};   // of a relay
  std::filesystem::path key_file = {};  // of the session
  bool apart = false;                   // each peer has a computer of its own (a lab's); else all are on this one
};

// The companions of a run, in the order of starting. Their configuration files are written at `islands.stem`.
[[nodiscard]] Result<std::vector<Companion>> companions_of(const config::RunSettings& run, const Islands& islands);

// The settings, as KEY=VALUE, by which run.peers[peer] reaches the others through the companions.
[[nodiscard]] std::vector<std::string> settings_by_companions(const config::RunSettings& run, const Islands& islands,
                                                              std::size_t peer);

}  // namespace peerd
