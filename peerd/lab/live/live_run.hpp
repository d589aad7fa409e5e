#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "peerd/peer/config/scenario.hpp"
#include "peerd/peer/node/peer_log.hpp"

namespace peerd::live {
class Lab;
}

namespace peerd {

// One run of a scenario between real processes: `peerd run` once for each peer, over the network of this computer or
// over a lab's.
struct LiveRun {
  std::filesystem::path program;               // peerd itself
  std::filesystem::path scenario;              // the scenario's file
  std::vector<std::filesystem::path> configs;  // merged over it, in order
  std::vector<std::string> sets;               // KEY=VALUE over both
  std::string interface;                       // empty: the scenario's, else lo
  bool tcpdump = false;                        // records each peer's interface as OUT/RUN_NAME.PEER.pcap; needs a lab
  std::filesystem::path out;                   // folder of the peers' logs and records
  std::string run_name;                        // such as run-001
  int port = 0;                                // port of the session, where the scenario names none
  live::Lab* lab = nullptr;                    // null: all peers are in this computer's own network
};

// Blocks SIGINT and SIGTERM, so that run_live() can wait for them and end its peers before this process ends.
void block_stop_signals();

// Runs the peers until all have left, shows progress on standard error, and gives the records of all peers but those
// that were killed. `oversleep_ms` gets by how much each of its waits of 20 ms took longer than that [ms].
[[nodiscard]] Result<std::vector<PeerLog>> run_live(const LiveRun& launch, const config::RunSettings& run,
                                                    std::vector<double>& oversleep_ms);

}  // namespace peerd
