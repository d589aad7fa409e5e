#pragma once
#include <filesystem>
#include <functional>
#include <vector>

#include "peerd/measure/run_record.hpp"
#include "peerd/node/peer_node.hpp"

namespace peerd::sim {

// Called with every output of every peer but its datagrams: for a log.
using Observer = std::function<void(HostTime true_now, const PeerNode&, const replication::Output&)>;

// Called with what became of every key that a peer's settings press.
using KeyObserver = std::function<void(HostTime true_now, const PeerNode&, const KeyReport&)>;

// Where each peer's capture goes (record/capture.hpp), and the scenario that the run is one of.
struct Captures {
  std::filesystem::path folder;  // that is there; NAME.pcapng
  const config::Scenario& scenario;
  std::filesystem::path file;  // the scenario's
};

// One run of a scenario on a simulated network, as fast as it goes: the peers are the daemon's own, only clock and
// network are not. The same settings give the same logs, byte for byte: one for each life of each peer, which has
// several where it leaves and comes back. `interest`, if given and a peer has an area of interest: what was found about
// those. `captures`: what they are recorded as; null: nothing is recorded.
[[nodiscard]] Result<std::vector<PeerLog>> simulate(const config::RunSettings& run, const SharedWorld& shared,
                                                    const Observer& observer = {}, const KeyObserver& key_observer = {},
                                                    std::optional<report::InterestRecord>* interest = nullptr,
                                                    const Captures* captures = nullptr);

// The same run where everybody knows everything at once: no latency, no loss, an update each tick, the lower id
// decides. Peers come and go as they do.
[[nodiscard]] config::RunSettings without_latency(config::RunSettings run);

}  // namespace peerd::sim
