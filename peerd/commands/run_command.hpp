#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace peerd {

struct PeerOptions {
  std::filesystem::path config;                 // a scenario file; one of its peers is run
  std::vector<std::filesystem::path> overlays;  // merged over it, in order
  std::vector<std::string> sets;
  std::string peer;               // which; empty: the only one
  std::filesystem::path record;   // where to leave the peer's log; empty: nowhere
  std::filesystem::path capture;  // where to keep all that it is told and sends (record/capture.hpp); empty: nowhere
  std::optional<std::string> control;  // of --control: where the control socket is; empty: nowhere
  bool once = false;                   // leave when the scenario's duration is over
  bool json = false;                   // log lines as JSON
  bool verbose = false;                // debug lines too
};

// peerd run, and with a capture peerd record: one peer in the foreground, until SIGTERM or SIGINT.
[[nodiscard]] int run_peer(const PeerOptions& options);

}  // namespace peerd
