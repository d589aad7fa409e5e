#pragma once
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "peerd/lab/measure/run_record.hpp"
#include "peerd/peer/node/peer_node.hpp"

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

// A peer at an instant, with its own clock's time.
struct SeenPeer {
  PeerNode* node;  // null: the peer is not there
  HostTime host;
};

// Sees all peers at the same true instants, between what they do. Only what leaves a peer as it is may be asked of it,
// and its view (PeerNode::advance_view).
class PeersWatch {
 public:
  virtual ~PeersWatch() = default;
  // The instants are those many a second, from the start of the motions to the run's end [Hz].
  [[nodiscard]] virtual std::uint32_t rate_hz() const = 0;
  // The motions' start has been agreed on: times below count from there.
  virtual void begin(SimTime start, HostTime true_at) = 0;
  // `peers`: in the run's order.
  virtual void see(double t_s, std::span<const SeenPeer> peers) = 0;
};

// Runs a scenario on a simulated network, as fast as it goes. The peers are the daemon's own; only clock and network
// are not. The same settings give the same logs, byte for byte: one log for each life of each peer, which has several
// lives where it leaves and comes back. `interest`, if not null, gets the findings about areas of interest where a peer
// has one. `captures`, if not null, says where the peers are recorded. `rows`, if not null, takes the rows of the logs,
// which do not keep them then. `watch`, if not null, sees the peers again and again.
[[nodiscard]] Result<std::vector<PeerLog>> simulate(const config::RunSettings& run, const SharedWorld& shared,
                                                    const Observer& observer = {},
                                                    const ActionObserver& action_observer = {},
                                                    std::optional<measure::InterestRecord>* interest = nullptr,
                                                    const Captures* captures = nullptr, LogRows* rows = nullptr,
                                                    const Progress& progress = {}, PeersWatch* watch = nullptr);

// The same run with perfect knowledge: no latency, no loss, an update each tick, and the lower id decides. Peers join
// and leave as before.
[[nodiscard]] config::RunSettings without_latency(config::RunSettings run);

}  // namespace peerd::sim
