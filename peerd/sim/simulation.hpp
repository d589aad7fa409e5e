#pragma once
#include <filesystem>
#include <functional>
#include <vector>

#include "peerd/measure/run_record.hpp"
#include "peerd/node/peer_node.hpp"

namespace peerd::sim {

// Called with every output of every peer except its datagrams, for a log.
using Observer = std::function<void(HostTime true_now, const PeerNode&, const replication::Output&)>;

// Called with each line about what a peer's settings make it do: keys that it presses, edits of the scene. `done`: it
// had its full effect.
using ActionObserver = std::function<void(HostTime true_now, const PeerNode&, const LogLine&, bool done)>;

// Called again and again while a run goes on, with the time since its motions began [s], or none before that. A run for
// which it returns false ends there.
using Progress = std::function<bool(std::optional<double> run_s)>;

// The folder of the peers' captures (record/capture.hpp), and the scenario of the run.
struct Captures {
  std::filesystem::path folder;  // exists already; files are NAME.pcapng
  const config::Scenario& scenario;
  std::filesystem::path file;  // the scenario's file
};

// Runs a scenario on a simulated network, as fast as it goes. The peers are the daemon's own; only clock and network
// are not. The same settings give the same logs, byte for byte: one log for each life of each peer, which has several
// lives where it leaves and comes back. `interest`, if not null, gets the findings about areas of interest where a peer
// has one. `captures`, if not null, says where the peers are recorded. `rows`, if not null, takes the rows of the logs,
// which do not keep them then.
[[nodiscard]] Result<std::vector<PeerLog>> simulate(const config::RunSettings& run, const SharedWorld& shared,
                                                    const Observer& observer = {},
                                                    const ActionObserver& action_observer = {},
                                                    std::optional<report::InterestRecord>* interest = nullptr,
                                                    const Captures* captures = nullptr, LogRows* rows = nullptr,
                                                    const Progress& progress = {});

// The same run with perfect knowledge: no latency, no loss, an update each tick, and the lower id decides. Peers join
// and leave as before.
[[nodiscard]] config::RunSettings without_latency(config::RunSettings run);

}  // namespace peerd::sim
