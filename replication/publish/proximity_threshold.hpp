#pragma once
#include <cstdint>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/output/peer_counters.hpp"
#include "replication/parts/part_at.hpp"
#include "replication/policy/peer_config.hpp"
#include "replication/replica/owners.hpp"
#include "replication/replica/replica.hpp"
#include "replication/world/model_in_force.hpp"

namespace peerd::replication {

// The error threshold of an own object's updates [m]: the tight one in close proximity to an object of another peer, so
// that a collision finds accurate ghosts (adaptive collision prediction tracking, Ohlenburg 2003, section 4.4.2).
class ProximityThreshold {
 public:
  // All arguments outlive this object.
  ProximityThreshold(const PeerConfig& config, const ModelInForce& model, const Owners& owners, const Replica& replica,
                     PeerCounters& counters);

  // The threshold in force at t, >= least_m().
  [[nodiscard]] double at(ObjectId object, SimTime t) const;
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
  [[nodiscard]] double time_to_contact_s(ObjectId object, SimTime t, double threshold_m) const;
  [[nodiscard]] bool is_anothers(const PartPair& parts, bool collider) const;
  [[nodiscard]] PartAt side_at(const Side& side, SimTime t) const;

  const PeerConfig& config_;
  const ModelInForce& model_;
  const Owners& owners_;
  const Replica& replica_;
  PeerCounters& counters_;
};

}  // namespace peerd::replication
