#pragma once
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "peerd/lab/measure/run_record.hpp"
#include "peerd/lab/sim/network.hpp"
#include "peerd/peer/node/peer_node.hpp"

namespace peerd::sim {

// A simulated peer as the oracle sees it.
struct WatchedPeer {
  const PeerNode* node;
  Duration clock_offset;
};

// Checks for each peer whether it holds the objects in its area of interest, and what it had to receive for that. The
// oracle knows nothing of cells, subscriptions or margins: it uses the true places of objects, the times at which
// updates were sent, and the state that a peer holds. An area is interest_radius_m around the viewpoint or, without
// one, around each own object, measured along the axes on which [regions] counts more than one region. An object is in
// the area where its farthest vertex reaches into it.
class InterestOracle {
 public:
  // The peers are those of `run`, in its order; only those with an interest_radius_m are checked.
  InterestOracle(const config::RunSettings& run, const Scene& scene, std::vector<WatchedPeer> peers);
  [[nodiscard]] static bool has_areas(const config::RunSettings& run);

  // The time of its next sample: from the start of the motions on, sample_hz times a second. None: not known yet, or
  // the run is over.
  [[nodiscard]] std::optional<VirtualTime> next_sample_time();
  void take_sample();  // at next_sample_time()
  void on_send(VirtualTime now, std::size_t from, RegionId region, std::span<const std::byte> datagram,
               const Network& network);
  void on_membership(VirtualTime now, std::size_t peer, bool joined);

  [[nodiscard]] measure::InterestRecord record() const;

 private:
  struct ObservedPeer {
    std::size_t peer;
    double radius_m;
    measure::PeerInterest found;
    std::uint64_t objects = 0, groups = 0;          // sums over all samples
    std::map<ObjectId, VirtualTime> missing_since;  // objects that are missing now
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
  replication::RegionGrid grid_;  // tells an update's own region from the one that its object left
  std::vector<ObservedPeer> observed_;
  std::map<ObjectId, std::size_t> owners_;
  std::map<ObjectId, double> reaches_m_;  // bounding radii of all objects that have had an owner
  std::map<ObjectId, std::deque<SentUpdate>> sent_updates_;
  std::optional<VirtualTime> begin_;  // begin of the motions
  std::uint64_t samples_taken_ = 0;
  measure::InterestRecord found_;
};

}  // namespace peerd::sim
