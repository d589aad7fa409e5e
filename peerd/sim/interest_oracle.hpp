#pragma once
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "peerd/measure/run_record.hpp"
#include "peerd/node/peer_node.hpp"
#include "peerd/sim/network.hpp"

namespace peerd::sim {

// A simulated peer as somebody sees it who sees everything.
struct WatchedPeer {
  const PeerNode* node;
  Duration clock_offset;
};

// Asks of each peer whether it knows of what is in its area of interest, and what it had to receive for that. Knows
// nothing of cells, of joining or of margins: it goes by where objects truly are, by which updates were sent when, and
// by what a peer says it holds. An area is interest_radius_m around the viewpoint, or, without one, around each own
// object, measured along the axes that [regions] counts more than one region on; in it is
// what has its farthest vertex no farther from its origin than the area is.
class InterestOracle {
 public:
  // The peers are those of `run`, in its order; only those with an interest_radius_m are asked.
  InterestOracle(const config::RunSettings& run, const Scene& scene, std::vector<WatchedPeer> peers);
  [[nodiscard]] static bool has_areas(const config::RunSettings& run);

  // When it wants to look next: from the start of the motions, sample_hz times a second. None: not yet, or never again.
  [[nodiscard]] std::optional<VirtualTime> next_sample_time();
  void take_sample();  // at next_look()
  void on_send(VirtualTime now, std::size_t from, RegionId region, std::span<const std::byte> datagram,
               const Network& network);
  void on_membership(VirtualTime now, std::size_t peer, bool joined);

  [[nodiscard]] report::InterestRecord record() const;

 private:
  struct ObservedPeer {
    std::size_t peer;
    double radius_m;
    report::PeerInterest found;
    std::uint64_t objects = 0, groups = 0;          // over all looks
    std::map<ObjectId, VirtualTime> missing_since;  // what is missing now
    std::deque<VirtualTime> joins_of_late;
  };
  struct SentUpdate {
    VirtualTime at;
    std::uint32_t sequence;
  };

  [[nodiscard]] SimTime session_time(std::size_t peer, VirtualTime t) const;
  [[nodiscard]] bool in_run(VirtualTime t);
  [[nodiscard]] KinematicState truth(ObjectId object, VirtualTime t) const;
  [[nodiscard]] bool in_area(const ObservedPeer& observed, ObjectId object, VirtualTime t) const;
  void take_sample(ObservedPeer& observed, VirtualTime t);
  [[nodiscard]] std::optional<VirtualTime> outdated_since(ObjectId object, std::uint32_t sequence) const;
  void close_gap(Duration length);

  config::RunSettings run_;
  const Scene& scene_;
  std::vector<WatchedPeer> peers_;
  replication::RegionGrid grid_;  // to tell an update's own region from the one that its object came from
  std::vector<ObservedPeer> observed_;
  std::map<ObjectId, std::size_t> owners_;
  std::map<ObjectId, double> reaches_m_;  // of whatever had an owner once
  std::map<ObjectId, std::deque<SentUpdate>> sent_updates_;
  std::optional<VirtualTime> begin_;  // of the motions
  std::uint64_t samples_taken_ = 0;
  report::InterestRecord found_;
};

}  // namespace peerd::sim
