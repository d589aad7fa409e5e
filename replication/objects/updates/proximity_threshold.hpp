#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/box.hpp"
#include "core/geometry/box_index.hpp"
#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/objects/replica/owners.hpp"
#include "replication/objects/replica/replica.hpp"
#include "replication/physics/parts/part_at.hpp"
#include "replication/physics/world/model_in_force.hpp"
#include "replication/settings/output/peer_counters.hpp"
#include "replication/settings/policy/peer_config.hpp"

namespace peerd::replication {

// The error threshold of an own object's updates [m]: the tight one in close proximity to an object of another peer, so
// that a collision finds accurate ghosts (adaptive collision prediction tracking, Ohlenburg 2003, section 4.4.2).
class ProximityThreshold {
 public:
  // All arguments outlive this object.
  ProximityThreshold(const PeerConfig& config, const ModelInForce& model, const Owners& owners, const Replica& replica,
                     PeerCounters& counters);

  // The threshold in force at t, >= least_m().
  [[nodiscard]] double at(ObjectId object, SimTime t);
  // The least threshold [m]: no error below it makes an update due, however close other objects are and whatever the
  // budget has.
  [[nodiscard]] double least_m(ObjectId object) const;

 private:
  // A side of a pair: a part, or for kNone the whole end.
  struct Side {
    std::uint32_t part;
    ObjectId end;
    friend bool operator==(const Side&, const Side&) = default;
  };

  [[nodiscard]] double usual_m(ObjectId object) const;
  [[nodiscard]] double time_to_contact_s(ObjectId object, SimTime t, double threshold_m);
  // A part pair of which what moves with an own object is a side, and what another peer moves the other.
  struct RemotePair {
    std::uint32_t part_pair;
    bool collider_is_mine;
  };
  // Those of one object, for as long as nobody else owns anything, this peer receives the same, and the model stays.
  struct RemotePairs {
    std::array<std::uint64_t, 3> revisions;
    std::vector<RemotePair> pairs;
  };
  // Most of what interests name stands and belongs to nobody: a tick does not ask for it. Pairs of groups are not among
  // these.
  [[nodiscard]] const std::vector<RemotePair>& remote_pairs_of(std::uint32_t node);
  // Ascending: those of remote_pairs_of(), and those of groups that may be in close proximity at t.
  [[nodiscard]] const std::vector<RemotePair>& near_pairs_of(std::uint32_t node, SimTime t);
  // Notes where the objects of other peers that are in groups may be within the close proximity from t on.
  void place_others(SimTime t);
  // The box of where the node's sphere is until the close proximity is over, and was for half as long before.
  [[nodiscard]] WorldBox way_of(std::uint32_t node, SimTime t) const;
  [[nodiscard]] bool is_anothers(const PartPair& parts, bool collider) const;
  [[nodiscard]] bool is_owned_by_another(ObjectId object) const;
  [[nodiscard]] std::array<std::uint64_t, 3> revisions() const;
  [[nodiscard]] PartAt side_at(const Side& side, SimTime t) const;

  const PeerConfig& config_;
  const ModelInForce& model_;
  const Owners& owners_;
  const Replica& replica_;
  PeerCounters& counters_;
  std::unordered_map<std::uint32_t, RemotePairs> remote_pairs_;  // by node of the model
  // The objects of other peers in groups, by node of the model.
  struct Others {
    std::array<std::uint64_t, 3> revisions{};
    std::optional<SimTime> placed_at;
    std::vector<std::uint32_t> nodes;
    BoxIndex index;
  };
  Others others_;
  std::vector<RemotePair> near_pairs_;  // what near_pairs_of() has returned last
};

}  // namespace peerd::replication
